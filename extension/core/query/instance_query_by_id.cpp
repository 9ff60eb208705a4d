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

/// If the cell of a point touches more tiles than this, it is cheaper to sample the set to find the
/// point's position.
constexpr double max_tiles = 4.0;

/// Maximum number of tiles to read for a layer that fills gaps. All tiles of the cell must be read,
/// because the set alone does not determine the layer's points.
constexpr double max_filled_tiles = 1024.0;

/// Finds the tile that contains a point, for a layer whose tiles are smaller than the set's cells.
/// The range is empty if the set has no such point.
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

/// Finds the tiles that may contain the instance of a point.
Status find_tiles_of(const QueryLayer &layer, std::uint64_t id, const SampleMargins &margins, TileRange &r_tiles) {
	const std::optional<Rect> area = area_of_point(layer, id);
	r_tiles = area ? TileWindow(layer).touching(*area) : TileRange();
	if (layer.fills && r_tiles.count() > max_filled_tiles) {
		return Status::out_of_range("number of tiles that may contain the instance", r_tiles.count(),
				at_most(max_filled_tiles), "Increase tile_size, or turn off spacing_fills");
	}
	if (r_tiles.count() > max_tiles && !layer.fills && !layer.set.in_rows) {
		// Reading this many tiles would take longer than sampling the set.
		return find_tile_of_point(layer, id, margins, r_tiles);
	}
	return {};
}

/// Returns the slabs that may contain the instance of a point.
TileWindow::Slabs slabs_of(const QueryLayer &layer, std::uint64_t id) {
	if (!layer.in_space()) {
		return {};
	}
	const CellHeights heights = cell_heights(layer.set, id);
	return TileWindow(layer).touching(heights.bottom, heights.top);
}

/// Adds the instance with this ID if the tile contains it.
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

std::optional<Rect> area_of_point(const QueryLayer &layer, std::uint64_t id) {
	if (!layer.set.in_rows) {
		return cell_rect(layer.set, id);
	}
	const std::optional<glm::dvec2> position =
			layer.rows != nullptr ? layer.rows->position(layer.set, id) : std::nullopt;
	return position ? std::optional(Rect{*position, *position}) : std::nullopt;
}

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
		const TileWindow::Slabs slabs = slabs_of(layer, id);
		for (std::int32_t y = range.first.y; y <= range.last.y; ++y) {
			for (std::int32_t x = range.first.x; x <= range.last.x; ++x) {
				for (std::int32_t slab = slabs.first; slab <= slabs.last && r_found.empty(); ++slab) {
					std::shared_ptr<const CompactTile> content;
					if (const Status status = tiles.find_tile({index, {x, y}, slab}, content); !status.ok()) {
						return status;
					}
					if (content != nullptr) {
						add_from(*content, id, index, r_found);
					}
				}
			}
		}
	}
	return {};
}

} // namespace thicket
