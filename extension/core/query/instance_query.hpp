#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/query/found_instances.hpp"
#include "core/query/placed_instance.hpp"
#include "core/sampling/point_set.hpp"
#include "core/state/instance_state.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The cylinder that represents an instance if only its transform is known. The cylinder extends from the instance's
/// origin along its own up axis. Meters at scale 1.
struct InstanceShape {
	double radius = 0.5; ///< 0 to 1e4.
	double height = 2.0; ///< 0 to 1e4.
};

/// A layer, as queries see it.
struct QueryLayer {
	bool wanted = true;      ///< False for a layer without instances.
	PointSet set;            ///< set.layer is at most max_state_layer.
	double tile_size = 64.0; ///< Meters, for the tiles of the source; 0.01 to 1e15.
	InstanceShape shape;
	double max_scale = 1.0;  ///< The largest scale of an instance of the set; 0 to 1e4.
	double max_offset = 0.0; ///< The most meters of an instance from its point, in the plane; 0 to 1e4.
};

/// A tile of a layer, of the size that the layer has at the time of the call.
struct WorldTile {
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// Provides tiles to queries.
class TileSource {
public:
	virtual ~TileSource() = default;

	/// The instances in a tile of a layer by its rules, including removed ones but not hand-placed ones. May generate
	/// the tile. Null, without an error, if the tile is not available now; it then counts as empty.
	virtual Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const CompactTile> &r_tile) = 0;

	/// Finds several tiles, in order, and replaces `r_tiles`. Returns the error of the first tile that failed. Throws
	/// std::bad_alloc.
	virtual Status find_tiles(
			std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

protected:
	TileSource() = default;
	TileSource(const TileSource &) = default;
	TileSource &operator=(const TileSource &) = default;
};

/// The instances that a query considers.
struct QueryFilter {
	std::vector<std::uint32_t> layers; ///< Indices in the list of layers; empty for all layers.

	/// A last condition, called in the order of the ids or of the distance, and only for instances that pass all other
	/// conditions. If empty, all instances pass.
	std::function<bool(const PlacedInstance &)> accepts;
};

/// The point where a ray meets an instance.
struct RayHit {
	PlacedInstance instance;
	double distance = 0.0; ///< Meters from the start of the ray.
};

/// The instance nearest to a position.
struct NearestInstance {
	PlacedInstance instance;
	double distance = 0.0; ///< Meters from that position to the instance's origin, in space.
};

/// Finds placed instances: the points of the sets that pass their layer's rules, without those that a state has removed, and with those
/// that were placed by hand. The answers depend only on the settings and the state, not on which tiles existed before. Works without an
/// engine. The caller owns all fields.
///
/// Coordinates and distances may be up to 1e15 meters. Values that are not finite or larger are refused by their name, as is a wanted layer
/// with an invalid number. After an error, which may come from the tile source, the result is empty. Tiles that are not entirely within the
/// cells of a set have no instances of it.
struct InstanceQuery {
	/// The most points, estimated from the density of the sets, in the tiles that one query may search. A tile counts as at least 16. More
	/// points are refused as `too_many_points`, by the name of the parameter that makes the query large: rect, radius, to or max_distance.
	static constexpr double max_points = 4e6;

	std::span<const QueryLayer> layers;
	TileSource &tiles;
	const InstanceState *state = nullptr; ///< Null: nothing was changed.
	SampleMargins margins{};              ///< For points that `by_id` samples itself.

	/// Finds instances whose origin lies in the half-open `rect` (world meters of x and z), ordered by layer, then id. Replaces `r_found`.
	/// A rectangle that is inverted or not finite is refused as `rect`, a layer that does not exist as `layer`.
	Status in_rect(const Rect &rect, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_rect(const Rect &rect, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// Finds instances whose origin lies within `radius` meters (0 or more) of `center`, in space, ordered by layer, then id.
	Status in_sphere(glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// Finds the first instance whose cylinder (InstanceShape, scaled, rotated and tilted with the instance) the ray
	/// from `from` to `to` meets. Of several at the same distance, finds the one with the smallest (layer, id). A ray
	/// that starts inside a cylinder meets it at 0. Replaces `r_hit` by one entry or none.
	Status on_ray(glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const;

	/// Finds the instance nearest to `position` in space, at most `max_distance` meters (0 or more) away. Ties are
	/// resolved as in on_ray. Replaces `r_found` by one entry or none.
	Status nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
			std::vector<NearestInstance> &r_found) const;

	/// Finds the instance with that id, if it is placed. Replaces `r_found` by one entry or none. Reads at most four tiles. If a layer's
	/// tiles are smaller than the squares of its set, it samples the set itself to find the tile.
	Status by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// Finds the instance with that id even if it is removed. The rules of its layer then determine its position.
	Status by_id_even_removed(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// The tiles that such a query reads, ordered by layer, and by distance within a layer. They must be generated for
	/// the query.
	using Tile = WorldTile;
	Status tiles_in_rect(const Rect &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
	Status tiles_in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;

private:
	// These do the work of the functions above, within the core's border (see core/base/guard.hpp). They throw
	// std::bad_alloc.
	Status find_in_rect(const Rect &rect, const QueryFilter &filter, FoundInstances &r_found) const;
	Status find_in_sphere(glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const;
	Status find_on_ray(glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const;
	Status find_nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
			std::vector<NearestInstance> &r_found) const;
	Status find_by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;
	Status find_tiles_in_rect(const Rect &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
	Status find_tiles_in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
};

} // namespace thicket
