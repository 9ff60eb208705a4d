#include "core/query/instance_query.hpp"

#include "core/base/check.hpp"
#include "core/query/tile_content.hpp"
#include "core/query/tile_window.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

Status check_rect(const Rect &rect) {
	for (const double bound : {rect.min.x, rect.min.y, rect.max.x, rect.max.y}) {
		if (const Status status = check_range("rect", bound, -max_query_coordinate, max_query_coordinate);
				!status.ok()) {
			return status;
		}
	}
	const glm::dvec2 size = rect.size();
	if (size.x < 0.0 || size.y < 0.0) {
		return {ErrorCode::inverted, "rect", std::min(size.x, size.y), {}, {}, negative_size};
	}
	return {};
}

Status check_sphere(glm::dvec3 center, double radius) {
	return first_failure(check_position("center", center), check_range("radius", radius, 0.0, max_query_coordinate));
}

/// Collects the instances in an area, layer by layer, ordered by ID. `inside(position)` returns
/// true if a position is in the area.
template <class Inside>
class Gathering {
public:
	Gathering(const InstanceQuery &query, const QueryFilter &filter, const Inside &inside) :
			query_(query), filter_(filter), inside_(inside) {}

	/// Adds the generated instances in `tiles`, which must all belong to one layer.
	Status add(std::span<const InstanceQuery::Tile> tiles, FoundInstances &r_found) {
		if (tiles.empty()) {
			return {};
		}
		if (const Status status = find(tiles); !status.ok()) {
			return status;
		}
		const std::uint32_t layer = tiles.front().layer;
		const RemovedPoints removed(query_.state, query_.layers[layer].set.layer);
		const std::size_t first = r_found.size();
		r_found.reserve(instances_);
		for (const std::shared_ptr<const CompactTile> &tile : tiles_) {
			add_from_tile(tile, layer, removed, r_found);
		}
		r_found.sort_from(first);
		if (filter_.accepts) {
			r_found.keep_from(first, filter_.accepts);
		}
		return {};
	}

	/// Adds hand-placed instances. Call this function after `add`, because their IDs are greater
	/// than all other IDs of their layer.
	void add_hand_placed(std::uint32_t index, const Rect &rect, FoundInstances &r_found) {
		for_hand_placed(query_, index, rect, [&](std::uint64_t id, const AddedInstance &added) {
			if (!inside_(added.position)) {
				return;
			}
			const PlacedInstance placed = placed_instance(id, index, added);
			if (!filter_.accepts || filter_.accepts(placed)) {
				r_found.add(placed);
			}
		});
	}

private:
	/// Loads the tiles into `tiles_` and counts their instances.
	Status find(std::span<const InstanceQuery::Tile> tiles) {
		instances_ = 0;
		if (const Status status = query_.tiles.find_tiles(tiles, tiles_); !status.ok()) {
			return status;
		}
		std::erase(tiles_, nullptr);
		for (const std::shared_ptr<const CompactTile> &tile : tiles_) {
			for (const CompactMesh &mesh : tile->meshes) {
				instances_ += mesh.size();
			}
		}
		return {};
	}

	void add_from_tile(const std::shared_ptr<const CompactTile> &tile, std::uint32_t layer,
			const RemovedPoints &removed, FoundInstances &r_found) {
		for (std::uint32_t mesh = 0; mesh < tile->meshes.size(); ++mesh) {
			const CompactMesh &content = tile->meshes[mesh];
			const std::span<const glm::vec3> positions = content.positions();
			inside_here_.clear();
			for (std::uint32_t i = 0; i < positions.size(); ++i) {
				if (inside_(position_of(tile->origin, positions[i]))) {
					inside_here_.push_back(i);
				}
			}
			if (inside_here_.empty()) {
				// The mesh is not added as a part, so that the result does not keep this mesh in
				// memory.
				continue;
			}
			const std::uint32_t part = r_found.add_part({tile, &content}, tile->origin, layer, mesh);
			for (const std::uint32_t i : inside_here_) {
				const std::uint64_t id = content.id(i);
				if (!removed.contains(id)) {
					r_found.add(FoundInstances::Ref{id, part, i});
				}
			}
		}
	}

	const InstanceQuery &query_;
	const QueryFilter &filter_;
	const Inside &inside_;
	std::size_t instances_ = 0; ///< Number of instances in `tiles_`.
	std::vector<std::shared_ptr<const CompactTile>> tiles_;
	std::vector<std::uint32_t> inside_here_;
};

template <class Inside>
Status gather(const InstanceQuery &query, const QueryFilter &filter, const QueryArea &area, const Inside &inside,
		FoundInstances &r_found) {
	std::vector<std::uint32_t> indices;
	std::vector<InstanceQuery::Tile> tiles;
	r_found.clear();
	if (const Status status = find_layers(query.layers, filter, indices); !status.ok()) {
		return status;
	}
	if (const Status status = find_tiles(query.layers, indices, area, tiles); !status.ok()) {
		return status;
	}
	Gathering gathering(query, filter, inside);
	auto next = tiles.begin();
	for (const std::uint32_t index : indices) {
		const auto first = next;
		next = std::find_if(first, tiles.end(), [&](const InstanceQuery::Tile &tile) { return tile.layer != index; });
		if (const Status status = gathering.add({first, next}, r_found); !status.ok()) {
			r_found.clear();
			return status;
		}
		gathering.add_hand_placed(index, area.space, r_found);
	}
	return {};
}

QueryArea area_of(const TileSpace &rect) {
	const glm::dvec2 center = rect.center();
	const double height = rect.covers_all_heights() ? 0.0 : 0.5 * (rect.bottom + rect.top);
	return {.property = "rect", .space = rect, .center = {center.x, height, center.y}};
}

QueryArea area_of(glm::dvec3 center, double radius) {
	return {.property = "radius", .space = space_around(center, radius), .center = center, .radius = radius};
}

Status tiles_in(std::span<const QueryLayer> layers, const QueryFilter &filter, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles) {
	std::vector<std::uint32_t> indices;
	r_tiles.clear();
	const Status status = find_layers(layers, filter, indices);
	return status.ok() ? find_tiles(layers, indices, area, r_tiles) : status;
}

} // namespace

Status TileSource::find_tiles(
		std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) {
	r_tiles.clear();
	for (const WorldTile &each : tiles) {
		std::shared_ptr<const CompactTile> content;
		if (const Status status = find_tile(each, content); !status.ok()) {
			return status;
		}
		r_tiles.push_back(std::move(content));
	}
	return {};
}

Status InstanceQuery::find_in_rect(const TileSpace &rect, const QueryFilter &filter, FoundInstances &r_found) const {
	if (const Status status = check_rect(rect); !status.ok()) {
		r_found.clear();
		return status;
	}
	const auto inside = [rect](glm::dvec3 position) {
		return rect.contains({position.x, position.z}) && rect.contains_height(position.y);
	};
	return gather(*this, filter, area_of(rect), inside, r_found);
}

Status InstanceQuery::find_in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const {
	if (const Status status = check_sphere(center, radius); !status.ok()) {
		r_found.clear();
		return status;
	}
	const auto inside = [center, squared = radius * radius](glm::dvec3 position) {
		return squared_length(position - center) <= squared;
	};
	return gather(*this, filter, area_of(center, radius), inside, r_found);
}

Status InstanceQuery::find_tiles_in_rect(
		const TileSpace &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const {
	if (const Status status = check_rect(rect); !status.ok()) {
		r_tiles.clear();
		return status;
	}
	return tiles_in(layers, filter, area_of(rect), r_tiles);
}

Status InstanceQuery::find_tiles_in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const {
	if (const Status status = check_sphere(center, radius); !status.ok()) {
		r_tiles.clear();
		return status;
	}
	return tiles_in(layers, filter, area_of(center, radius), r_tiles);
}

} // namespace thicket
