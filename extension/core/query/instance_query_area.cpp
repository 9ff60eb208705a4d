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
		return {ErrorCode::inverted, "rect", std::min(size.x, size.y)};
	}
	return {};
}

Status check_sphere(glm::dvec3 center, double radius) {
	return first_failure(check_position("center", center), check_range("radius", radius, 0.0, max_query_coordinate));
}

/// All of one layer that stand in tiles that are looked at and, by `inside` of their position, in the area; by id.
template <class Inside>
class Gathering {
public:
	Gathering(const InstanceQuery &query, const QueryFilter &filter, const Inside &inside) :
			query_(query), filter_(filter), inside_(inside) {}

	/// Adds what stands in tiles of one layer.
	Status add(std::span<const InstanceQuery::Tile> tiles, std::vector<PlacedInstance> &r_found) {
		if (tiles.empty()) {
			return {};
		}
		if (const Status status = find(tiles); !status.ok()) {
			return status;
		}
		const std::uint32_t layer = tiles.front().layer;
		const RemovedPoints removed(query_.state, query_.layers[layer].set.layer);
		for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
			look_at(tile, removed);
		}
		sort_by_id(refs_);
		if (!filter_.accepts) {
			r_found.reserve(r_found.size() + refs_.size());
		}
		for (const InstanceRef &ref : refs_) {
			keep(placed_instance(ref.id, layer, ref.mesh, tiles_[ref.tile]->origin, ref.transform), r_found);
		}
		return {};
	}

	/// Adds what was placed by hand: their ids come after all others of their layer.
	void add_hand_placed(std::uint32_t index, const Rect &rect, std::vector<PlacedInstance> &r_found) {
		for_hand_placed(query_, index, rect, [&](std::uint64_t id, const AddedInstance &added) {
			if (inside_(added.position)) {
				keep(placed_instance(id, index, added), r_found);
			}
		});
	}

private:
	/// Gets hold of the tiles, and makes room for all that they hold.
	Status find(std::span<const InstanceQuery::Tile> tiles) {
		std::size_t instances = 0;
		tiles_.clear();
		for (const InstanceQuery::Tile &each : tiles) {
			std::shared_ptr<const TileInstances> content;
			if (const Status status = query_.tiles.find_tile(each.layer, each.tile, content); !status.ok()) {
				return status;
			}
			if (content != nullptr) {
				for (const MeshInstances &mesh : content->meshes) {
					instances += mesh.size();
				}
				tiles_.push_back(std::move(content));
			}
		}
		refs_.clear();
		refs_.reserve(instances);
		return {};
	}

	void look_at(std::uint32_t tile, const RemovedPoints &removed) {
		const TileInstances &content = *tiles_[tile];
		for (std::uint32_t mesh = 0; mesh < content.meshes.size(); ++mesh) {
			const MeshInstances &instances = content.meshes[mesh];
			const float *transform = instances.buffer.data();
			for (const std::uint64_t id : instances.ids) {
				if (inside_(position_of(content.origin, transform)) && !removed.holds(id)) {
					refs_.push_back({id, transform, tile, mesh});
				}
				transform += instances.stride;
			}
		}
	}

	void keep(const PlacedInstance &placed, std::vector<PlacedInstance> &r_found) const {
		if (!filter_.accepts || filter_.accepts(placed)) {
			r_found.push_back(placed);
		}
	}

	const InstanceQuery &query_;
	const QueryFilter &filter_;
	const Inside &inside_;
	std::vector<InstanceRef> refs_;
	std::vector<std::shared_ptr<const TileInstances>> tiles_;
};

template <class Inside>
Status gather(const InstanceQuery &query, const QueryFilter &filter, const QueryArea &area, const Inside &inside,
		std::vector<PlacedInstance> &r_found) {
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
		gathering.add_hand_placed(index, area.rect, r_found);
	}
	return {};
}

QueryArea area_of(const Rect &rect) { return {.property = "rect", .rect = rect, .center = rect.center()}; }

QueryArea area_of(glm::dvec3 center, double radius) {
	const glm::dvec2 middle(center.x, center.z);
	return {.property = "radius", .rect = rect_around(middle, radius), .center = middle, .radius = radius};
}

Status tiles_in(std::span<const QueryLayer> layers, const QueryFilter &filter, const QueryArea &area,
		std::vector<InstanceQuery::Tile> &r_tiles) {
	std::vector<std::uint32_t> indices;
	r_tiles.clear();
	const Status status = find_layers(layers, filter, indices);
	return status.ok() ? find_tiles(layers, indices, area, r_tiles) : status;
}

} // namespace

Status InstanceQuery::find_in_rect(
		const Rect &rect, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const {
	if (const Status status = check_rect(rect); !status.ok()) {
		r_found.clear();
		return status;
	}
	const auto inside = [rect](glm::dvec3 position) {
		return rect.contains({position.x, position.z});
	};
	return gather(*this, filter, area_of(rect), inside, r_found);
}

Status InstanceQuery::find_in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const {
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
		const Rect &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const {
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
