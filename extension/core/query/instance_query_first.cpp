#include "core/query/instance_query.hpp"

#include "core/base/check.hpp"
#include "core/base/tile_grid.hpp"
#include "core/query/candidates.hpp"
#include "core/query/instance_ray.hpp"
#include "core/query/search_tiles.hpp"
#include "core/query/tile_content.hpp"
#include "core/query/tile_window.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace thicket {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The order of a heap with the first on top.
bool farther(const SearchTile &a, const SearchTile &b) { return a.from > b.from; }

/// Finds the first of all instances in some tiles. `scan(layer, content, candidates)` adds the candidates of a tile.
template <class Scan>
Status search(const InstanceQuery &query, std::vector<SearchTile> &tiles, Candidates &candidates, const Scan &scan,
		bool &r_found) {
	std::make_heap(tiles.begin(), tiles.end(), farther);
	r_found = false;
	while (!tiles.empty() && !r_found) {
		const SearchTile next = tiles.front();
		r_found = candidates.settle(next.from);
		if (r_found) {
			// In all further tiles, everything comes later.
			return {};
		}
		std::pop_heap(tiles.begin(), tiles.end(), farther);
		tiles.pop_back();
		std::shared_ptr<const CompactTile> content;
		if (const Status status = query.tiles.find_tile(next.layer, next.tile, content); !status.ok()) {
			return status;
		}
		if (content != nullptr) {
			scan(next.layer, *content, candidates);
		}
	}
	r_found = candidates.settle(never);
	return {};
}

// Search for the nearest instance.

/// Scans instances by their distance from a position; `at` is its square.
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
					// A different instance is nearer.
					continue;
				}
				if (squared <= max_squared && !removed.holds(instances.id(i))) {
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

// Search along a ray.

Rect rect_along(const Ray &ray, double distance) {
	const glm::dvec3 to = ray.at(1.0);
	const Rect from = rect_around({ray.from.x, ray.from.z}, distance);
	const Rect until = rect_around({to.x, to.z}, distance);
	return {glm::min(from.min, until.min), glm::max(from.max, until.max)};
}

/// Finds the instances of one layer that a ray meets; `at` is a share of its length.
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
				// No instance in this box reaches the ray.
				continue;
			}
			const std::span<const glm::vec3> positions = instances.positions();
			for (std::size_t i = 0; i < positions.size(); ++i) {
				if (!reached.position(position_of(content.origin, positions[i]))) {
					// No cylinder is so long or wide.
					continue;
				}
				if (!removed.holds(instances.id(i))) {
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
		// The axes of hand-placed instances may have any lengths and angles.
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
	const glm::dvec2 center(position.x, position.z);
	const Rect around = rect_around(center, max_distance);
	std::vector<Tile> wanted;
	status = find_tiles(layers, indices,
			{.property = "max_distance", .rect = around, .center = center, .radius = max_distance}, wanted);
	if (!status.ok()) {
		return status;
	}
	std::vector<SearchTile> searched;
	for (const Tile &each : wanted) {
		const Rect area = TileWindow(layers[each.layer]).standing_area(each.tile);
		searched.push_back({distance_squared(area, center), each.layer, each.tile});
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
