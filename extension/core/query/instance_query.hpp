#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/query/found_instances.hpp"
#include "core/query/placed_instance.hpp"
#include "core/rows/row_set.hpp"
#include "core/sampling/point_set.hpp"
#include "core/state/instance_state.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// The cylinder that approximates an instance in ray queries. It extends from the instance's origin
/// along the instance's up axis. Sizes are in meters at scale 1.
struct InstanceShape {
	double radius = 0.5; ///< Meters, 0 to 1e4.
	double height = 2.0; ///< Meters, 0 to 1e4.
};

/// The properties of a layer that queries need.
struct QueryLayer {
	bool wanted = true; ///< If false, queries skip this layer.
	PointSet set;       ///< set.layer is at most max_state_layer.
	/// True if the layer fills gaps, so that the set alone does not determine its points.
	bool fills = false;
	std::shared_ptr<const RowSet> rows{}; ///< See LayerSettings::rows.
	double tile_size = 64.0;              ///< Size of the source's tiles in meters, 0.01 to 1e15.
	InstanceShape shape;
	double max_scale = 1.0; ///< Upper bound for the scale of generated instances, 0 to 1e4.
	/// Largest distance in meters of an instance from its point, 0 to 2e4. On a planet, this is the
	/// distance in space, otherwise the horizontal distance.
	double max_offset = 0.0;
	/// The range of heights of a layer on a planet, whose tiles are cubes; see StreamLayer.
	double bottom = -std::numeric_limits<double>::infinity();
	double top = std::numeric_limits<double>::infinity();

	/// Returns true if the tiles are cubes.
	bool in_space() const { return top < std::numeric_limits<double>::infinity(); }
};

/// Returns an area that contains the point with an ID; no value if the layer is in rows and none of them
/// contains this point.
std::optional<Rect> area_of_point(const QueryLayer &layer, std::uint64_t id);

/// A tile of a layer, in units of the layer's current tile size.
struct WorldTile {
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
	std::int32_t slab = all_slabs; ///< The slab, if the layer's tiles are cubes.

	friend bool operator==(const WorldTile &, const WorldTile &) = default;
};

/// Provides tiles to queries.
class TileSource {
public:
	virtual ~TileSource() = default;

	/// Finds or generates a tile: all instances that the rules permit, including removed ones but
	/// not hand-placed ones. If the tile is not available now, sets `r_tile` to null, without an
	/// error. The tile is then treated as empty.
	virtual Status find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) = 0;

	/// Replaces `r_tiles` with the given tiles, in order. Returns the error of the first tile that
	/// failed. Throws std::bad_alloc.
	virtual Status find_tiles(
			std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

protected:
	TileSource() = default;
	TileSource(const TileSource &) = default;
	TileSource &operator=(const TileSource &) = default;
};

/// Restricts the instances that a query finds.
struct QueryFilter {
	std::vector<std::uint32_t> layers; ///< Indices in InstanceQuery::layers; empty for all layers.

	/// An additional condition, called only for instances that meet all other conditions, in the
	/// order of IDs or distance. If empty, all instances pass.
	std::function<bool(const PlacedInstance &)> accepts;
};

/// The instance that a ray hits first.
struct RayHit {
	PlacedInstance instance;
	double distance = 0.0; ///< Distance in meters from the start of the ray.
};

/// The instance nearest to a position.
struct NearestInstance {
	PlacedInstance instance;
	double distance = 0.0; ///< Distance in meters from the queried position to the instance's origin, in 3D.
};

/// Finds the instances of a world: generated instances that the state has not removed, and
/// hand-placed ones. If the source generates missing tiles, results depend only on the settings and
/// the state. Queries do not depend on Godot. The objects that the fields refer to must outlive the
/// query.
///
/// Coordinates and distances may be up to 1e15 meters. Larger values and values that are not finite
/// are errors that name the parameter. Wanted layers with invalid settings are errors, too. After
/// any error, including one of the tile source, the result is empty. Tiles that are not entirely
/// within the cells of a set are treated as empty.
struct InstanceQuery {
	/// The maximum number of points in the tiles that one query may search, estimated from the
	/// density of the sets. Each tile is counted as at least 16 points. A larger query returns
	/// ErrorCode::too_many_points with the name of the parameter that makes it large: rect, radius,
	/// to or max_distance.
	static constexpr double max_points = 4e6;

	std::span<const QueryLayer> layers;
	TileSource &tiles;
	const InstanceState *state = nullptr; ///< Null if nothing was changed.
	SampleMargins margins{};              ///< The sampling margins that `by_id` uses when it samples the point set.

	/// Finds instances whose origin is in `rect` (world meters), ordered by layer, then ID. `rect`
	/// may have a limited range of heights. Replaces `r_found`. A rectangle that is inverted or not
	/// finite is an error that names `rect`. A layer that does not exist is an error that names
	/// `layer`.
	Status in_rect(const TileSpace &rect, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_rect(const TileSpace &rect, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// Finds instances whose origin is within `radius` meters (0 or more) of `center` in 3D,
	/// ordered by layer, then ID. Replaces `r_found`.
	Status in_sphere(glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// Finds the first instance whose cylinder (InstanceShape, transformed with the instance) is
	/// hit by the ray from `from` to `to`. If several are at the same distance, the one with the
	/// smallest (layer, ID) is found. A ray that starts inside a cylinder hits it at distance 0.
	/// Replaces `r_hit` with one entry, or none.
	Status on_ray(glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const;

	/// Finds the instance nearest to `position` in 3D, at most `max_distance` meters (0 or more)
	/// away. Ties are resolved as in on_ray. Replaces `r_found` with one entry, or none.
	Status nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
			std::vector<NearestInstance> &r_found) const;

	/// Finds the instance with this ID, if it is placed. Replaces `r_found` with one entry, or
	/// none. The query reads at most four tiles. If the cell of the ID touches more, it samples the
	/// point set to find the right one.
	Status by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// Finds the instance with this ID even if it was removed, as the rules of its layer would
	/// place it.
	Status by_id_even_removed(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// These functions list the tiles that a query with the same arguments reads, so that they can
	/// be generated first. The tiles are ordered by layer and, within a layer, by distance.
	using Tile = WorldTile;
	Status tiles_in_rect(const TileSpace &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
	Status tiles_in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;

private:
	// Implementations of the functions above, which catch their exceptions (see
	// core/base/guard.hpp). The implementations throw std::bad_alloc.
	Status find_in_rect(const TileSpace &rect, const QueryFilter &filter, FoundInstances &r_found) const;
	Status find_in_sphere(glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const;
	Status find_on_ray(glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const;
	Status find_nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
			std::vector<NearestInstance> &r_found) const;
	Status find_by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;
	Status find_tiles_in_rect(const TileSpace &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
	Status find_tiles_in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
};

} // namespace thicket
