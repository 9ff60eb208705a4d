#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/kept_tile.hpp"
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

/// The cylinder that stands for an instance where only its transform is known: from its origin along its own up axis,
/// meters at scale 1.
struct InstanceShape {
	double radius = 0.5; ///< 0 to 1e4.
	double height = 2.0; ///< 0 to 1e4.
};

/// A layer, to those who ask for its instances.
struct QueryLayer {
	bool wanted = true;      ///< False for a layer of which nothing stands.
	PointSet set;            ///< set.layer is at most max_state_layer.
	double tile_size = 64.0; ///< Meters, of the tiles that the source has; 0.01 to 1e15.
	InstanceShape shape;
	double max_scale = 1.0;  ///< The largest that an instance of the set can have; 0 to 1e4.
	double max_offset = 0.0; ///< Meters from its point at most, in the plane (offset_along_normal); 0 to 1e4.
};

/// A tile of a layer, of the size that the layer has at the time.
struct WorldTile {
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// Where queries get tiles from.
class TileSource {
public:
	virtual ~TileSource() = default;

	/// What stands in a tile of a layer by its rules, removed ones included, hand-placed ones not. May make it. Null,
	/// without an error, where there is nothing to be had for now: such a tile counts as empty.
	virtual Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> &r_tile) = 0;

	/// Several, in order: replaces `r_tiles`. The error is that of the first which has one. Throws std::bad_alloc.
	virtual Status find_tiles(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles);

protected:
	TileSource() = default;
	TileSource(const TileSource &) = default;
	TileSource &operator=(const TileSource &) = default;
};

/// Which instances a query looks at.
struct QueryFilter {
	std::vector<std::uint32_t> layers; ///< Indices in the list of layers; none for all.

	/// Asked last, in the order of the ids or of the distance, and only for what would be an answer otherwise. None:
	/// all pass.
	std::function<bool(const PlacedInstance &)> accepts;
};

/// Where a ray meets an instance.
struct RayHit {
	PlacedInstance instance;
	double distance = 0.0; ///< Meters from the start of the ray.
};

/// The instance nearest to a position.
struct NearestInstance {
	PlacedInstance instance;
	double distance = 0.0; ///< Meters from that position to the instance's origin, in space.
};

/// Asks what stands where: the points of the sets that pass their layer's rules, without those that a state has removed
/// and with those that were placed by hand. The answers depend on the settings and the state alone, not on which tiles
/// were there before. Works without an engine. All fields stay the caller's.
///
/// Coordinates and distances go to 1e15 meters; what is not finite or beyond is refused by its name, as is a wanted
/// layer with a number that cannot be. After an error, which may be one of the tiles' source, the result is empty.
/// Nothing of a set stands in a tile that is not wholly within the set's cells.
struct InstanceQuery {
	/// The most points, by the density of the sets, in the tiles that one query may look at (a tile counts as 16 at
	/// least); more are refused as `too_many_points`, by the name of what makes the query large: rect, radius, to or
	/// max_distance.
	static constexpr double max_points = 4e6;

	std::span<const QueryLayer> layers;
	TileSource &tiles;
	const InstanceState *state = nullptr; ///< Null: nothing was changed.
	SampleMargins margins{};              ///< Of what `by_id` samples itself.

	/// Instances whose origin lies in the half-open `rect` (world meters of x and z), by layer, then id. Replaces
	/// `r_found`. A rectangle that is inverted or not finite is refused as `rect`, a layer that is not there as
	/// `layer`.
	Status in_rect(const Rect &rect, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_rect(const Rect &rect, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// Instances whose origin lies within `radius` meters (0 or more) of `center`, in space, by layer, then id.
	Status in_sphere(glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const;
	Status in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const;

	/// The first instance whose cylinder (InstanceShape, scaled, turned and tilted with the instance) the ray from
	/// `from` to `to` meets; of several at the same distance the smallest (layer, id). A ray that starts inside meets
	/// it at 0. Replaces `r_hit` by one or none.
	Status on_ray(glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const;

	/// The instance nearest to `position` in space, at most `max_distance` meters (0 or more) away; ties as above.
	/// Replaces `r_found` by one or none.
	Status nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
			std::vector<NearestInstance> &r_found) const;

	/// The instance of that id, if it stands. Replaces `r_found` by one or none. Looks at four tiles at
	/// most; where a layer's tiles are smaller than the squares of its set, it has the set itself say which one.
	Status by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// The same, removed or not: where a point of the set would stand by its layer's rules.
	Status by_id_even_removed(std::uint64_t id, std::vector<PlacedInstance> &r_found) const;

	/// The tiles that such a query looks at, by layer and nearest first; what has to be made for it.
	using Tile = WorldTile;
	Status tiles_in_rect(const Rect &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;
	Status tiles_in_sphere(
			glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const;

private:
	// What the above do within the core's border (see core/base/guard.hpp). They throw std::bad_alloc.
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
