#include "core/query/instance_query.hpp"

#include "core/base/check.hpp"
#include "core/base/tile_grid.hpp"
#include "core/query/candidates.hpp"
#include "core/query/instance_ray.hpp"
#include "core/query/search_tiles.hpp"
#include "core/query/tile_content.hpp"
#include "core/query/tile_window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace thicket {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Defines the order of a heap with the first tile on top.
bool farther(const SearchTile &a, const SearchTile &b) { return a.from > b.from; }

/// Finds the first instance in `tiles` and empties that list. `scan(layer, content, candidates)`
/// adds the candidates of a tile.
template <class Scan>
Status search(const InstanceQuery &query, std::vector<SearchTile> &tiles, Candidates &candidates, const Scan &scan,
		bool &r_found) {
	std::make_heap(tiles.begin(), tiles.end(), farther);
	r_found = false;
	while (!tiles.empty() && !r_found) {
		const SearchTile next = tiles.front();
		r_found = candidates.settle(next.from);
		if (r_found) {
			// All instances in the remaining tiles come later.
			return {};
		}
		std::pop_heap(tiles.begin(), tiles.end(), farther);
		tiles.pop_back();
		std::shared_ptr<const CompactTile> content;
		if (const Status status = query.tiles.find_tile(next.tile, content); !status.ok()) {
			return status;
		}
		if (content != nullptr) {
			scan(next.tile.layer, *content, candidates);
		}
	}
	r_found = candidates.settle(never);
	return {};
}

// The functions below search for the nearest instance.

/// Finds instances by distance from a position. Candidate::at is the squared distance.
struct NearestScan {
	const InstanceQuery &query;
	glm::dvec3 position;
	double max_squared;

	void operator()(std::uint32_t layer, const CompactTile &content, Candidates &r_candidates) const {
		const RemovedPoints removed(query.state, query.layers[layer].set.layer);
		for (std::uint32_t mesh = 0; mesh < content.meshes.size(); ++mesh) {
			const CompactMesh &instances = content.meshes[mesh];
			const std::span<const glm::vec3> positions = instances.positions();
			for (std::size_t i = 0; i < positions.size(); ++i) {
				const double squared = squared_length(position_of(content.origin, positions[i]) - position);
				if (squared > r_candidates.limit()) {
					// A candidate found earlier is nearer.
					continue;
				}
				if (squared <= max_squared && !removed.contains(instances.id(i))) {
					r_candidates.add({squared, placed_instance(layer, mesh, content.origin, instances, i)});
				}
			}
		}
	}

	void hand_placed(std::uint32_t layer, const Rect &rect, Candidates &r_candidates) const {
		for_hand_placed(query, layer, rect, [&](std::uint64_t id, const AddedInstance &added) {
			const double squared = squared_length(added.position - position);
			if (squared <= std::min(max_squared, r_candidates.limit())) {
				r_candidates.add({squared, placed_instance(id, layer, added)});
			}
		});
	}
};

// The functions below search along a ray.

Rect rect_along(const Ray &ray, double distance) {
	const glm::dvec3 to = ray.at(1.0);
	const Rect from = rect_around({ray.from.x, ray.from.z}, distance);
	const Rect until = rect_around({to.x, to.z}, distance);
	return united(from, until);
}

/// Finds instances that a ray hits. Candidate::at is a fraction of the ray's length.
struct RayScan {
	const InstanceQuery &query;
	Ray ray;

	void operator()(std::uint32_t layer, const CompactTile &content, Candidates &r_candidates) const {
		const QueryLayer &settings = query.layers[layer];
		const RemovedPoints removed(query.state, settings.set.layer);
		for (std::uint32_t mesh = 0; mesh < content.meshes.size(); ++mesh) {
			const CompactMesh &instances = content.meshes[mesh];
			const ReachTest reached(ray, cylinder_reach(settings.shape, double{instances.max_scale()}));
			if (!reached.box(
						content.origin + glm::dvec3(instances.min()), content.origin + glm::dvec3(instances.max()))) {
				// The ray misses all instances of this mesh.
				continue;
			}
			const std::span<const glm::vec3> positions = instances.positions();
			for (std::size_t i = 0; i < positions.size(); ++i) {
				if (!reached.position(position_of(content.origin, positions[i]))) {
					// The ray is out of reach of this instance.
					continue;
				}
				if (!removed.contains(instances.id(i))) {
					meet(placed_instance(layer, mesh, content.origin, instances, i), r_candidates);
				}
			}
		}
	}

	void hand_placed(std::uint32_t layer, Candidates &r_candidates) const {
		if (query.state == nullptr) {
			return;
		}
		const QueryLayer &settings = query.layers[layer];
		// The basis of a hand-placed instance may be sheared, so a larger bound is needed.
		const double reach = (std::numbers::sqrt2 * settings.shape.radius + settings.shape.height) *
				query.state->max_added_scale(settings.set.layer);
		for_hand_placed(query, layer, rect_along(ray, reach), [&](std::uint64_t id, const AddedInstance &added) {
			meet(placed_instance(id, layer, added), r_candidates);
		});
	}

private:
	void meet(const PlacedInstance &placed, Candidates &r_candidates) const {
		const RayPart part = inside_cylinder(ray, query.layers[placed.layer].shape, placed.position, placed.basis);
		if (!part.empty() && part.start <= r_candidates.limit()) {
			r_candidates.add({part.start, placed});
		}
	}
};

} // namespace

Status InstanceQuery::find_nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
		std::vector<NearestInstance> &r_found) const {
	r_found.clear();
	std::vector<std::uint32_t> indices;
	Status status = first_failure(check_position("position", position),
			check_range("max_distance", max_distance, 0.0, max_query_coordinate), find_layers(layers, filter, indices));
	if (!status.ok()) {
		return status;
	}
	const TileSpace around = space_around(position, max_distance);
	std::vector<Tile> wanted;
	status = find_tiles(layers, indices,
			{.property = "max_distance", .space = around, .center = position, .radius = max_distance}, wanted);
	if (!status.ok()) {
		return status;
	}
	std::vector<SearchTile> searched;
	for (const Tile &each : wanted) {
		const TileSpace space = TileWindow(layers[each.layer]).standing_space(each.tile, each.slab);
		searched.push_back({distance_squared(space, position), each});
	}
	Candidates candidates(filter);
	const NearestScan scan{*this, position, max_distance * max_distance};
	for (const std::uint32_t index : indices) {
		scan.hand_placed(index, around, candidates);
	}
	bool found = false;
	status = search(*this, searched, candidates, scan, found);
	if (found) {
		r_found.push_back({candidates.answer().instance, std::sqrt(candidates.answer().at)});
	}
	return status;
}

Status InstanceQuery::find_on_ray(
		glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const {
	r_hit.clear();
	std::vector<std::uint32_t> indices;
	Status status =
			first_failure(check_position("from", from), check_position("to", to), find_layers(layers, filter, indices));
	if (!status.ok()) {
		return status;
	}
	const Ray ray{from, to - from};
	std::vector<SearchTile> tiles_on_way;
	status = find_ray_tiles(layers, indices, ray, tiles_on_way);
	if (!status.ok()) {
		return status;
	}
	Candidates candidates(filter);
	const RayScan scan{*this, ray};
	for (const std::uint32_t index : indices) {
		scan.hand_placed(index, candidates);
	}
	bool found = false;
	status = search(*this, tiles_on_way, candidates, scan, found);
	if (found) {
		const double length = std::sqrt(squared_length(ray.along));
		r_hit.push_back({candidates.answer().instance, candidates.answer().at * length});
	}
	return status;
}

} // namespace thicket
