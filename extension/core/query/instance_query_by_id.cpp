#include "core/query/instance_query.hpp"

#include "core/base/instance_id.hpp"
#include "core/base/tile_grid.hpp"
#include "core/query/tile_content.hpp"
#include "core/query/tile_window.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace thicket {

namespace {

/// If a cell of a point set touches more tiles than this, it is cheaper to sample the set to find the position of its point.
constexpr double most_tiles = 4.0;

/// Finds the tile in which the point of a cell lies, for a layer whose tiles are smaller than its cells; none if the cell has no point.
Status find_tile_of_point(const QueryLayer &layer, std::uint64_t id, const SampleMargins &margins, TileRange &r_tiles) {
	const Rect square = cell_rect(layer.set, id);
	const double edge = set_extent(layer.set);
	TileSampler sampler(margins);
	std::vector<SamplePoint> points;
	const Rect within{glm::max(square.min, -edge), glm::min(square.max, edge)};
	if (const Status status = sampler.sample(layer.set, within, points); !status.ok()) {
		return status;
	}
	r_tiles = {};
	const auto found =
			std::find_if(points.begin(), points.end(), [id](const SamplePoint &point) { return point.id == id; });
	if (found != points.end()) {
		r_tiles = TileWindow(layer).touching({found->position, found->position});
	}
	return {};
}

/// Finds the tiles that may hold a point of the set.
Status find_tiles_of(const QueryLayer &layer, std::uint64_t id, const SampleMargins &margins, TileRange &r_tiles) {
	r_tiles = TileWindow(layer).touching(cell_rect(layer.set, id));
	if (r_tiles.count() > most_tiles) {
		// The set itself locates the point among very many tiles.
		return find_tile_of_point(layer, id, margins, r_tiles);
	}
	return {};
}

/// Adds the instance of that id, if it is in the tile.
void add_from(const CompactTile &content, std::uint64_t id, std::uint32_t index, std::vector<PlacedInstance> &r_found) {
	for (std::uint32_t mesh = 0; mesh < content.meshes.size() && r_found.empty(); ++mesh) {
		const CompactMesh &instances = content.meshes[mesh];
		const std::size_t at = instances.find(id);
		if (at < instances.size()) {
			r_found.push_back(placed_instance(index, mesh, content.origin, instances, at));
		}
	}
}

} // namespace

Status InstanceQuery::find_by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const {
	r_found.clear();
	for (std::uint32_t index = 0; index < layers.size() && r_found.empty(); ++index) {
		const QueryLayer &layer = layers[index];
		if (!layer.wanted || layer.set.layer != layer_of(id)) {
			continue;
		}
		if (const Status status = validate(layer); !status.ok()) {
			return status;
		}
		if (is_added(id)) {
			const AddedInstance *added = state != nullptr ? state->added(id) : nullptr;
			if (added != nullptr) {
				r_found.push_back(placed_instance(id, index, *added));
			}
			continue;
		}
		TileRange range;
		if (const Status status = find_tiles_of(layer, id, margins, range); !status.ok()) {
			return status;
		}
		for (std::int32_t y = range.first.y; y <= range.last.y && r_found.empty(); ++y) {
			for (std::int32_t x = range.first.x; x <= range.last.x && r_found.empty(); ++x) {
				std::shared_ptr<const CompactTile> content;
				if (const Status status = tiles.find_tile(index, {x, y}, content); !status.ok()) {
					return status;
				}
				if (content != nullptr) {
					add_from(*content, id, index, r_found);
				}
			}
		}
	}
	return {};
}

} // namespace thicket
