#include "core/drawing/cell_drawing.hpp"

#include "core/placement/tile_instances.hpp"

#include <algorithm>

namespace thicket {

void adapt(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		CellDrawing &r_cell) {
	r_cell.remaining_fraction = thinned_density(settings, distance.near);
	r_cell.scale = static_cast<float>(compensating_scale(settings, r_cell.remaining_fraction));
	r_cell.lod = lod_at(settings, distance.near, r_cell.lod);
	r_cell.span =
			steps.empty() ? LodSpan{r_cell.lod, r_cell.lod, false} : lod_span(settings, steps, distance, r_cell.span);
}

double adapted_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance) {
	const double margin = distance_margin(settings, distance.near);
	return steps.empty() ? margin : std::min(margin, span_margin(settings, steps, distance));
}

std::size_t drawn_by_extra_lod(
		std::span<const std::uint32_t> ranks, double first_fraction, double fraction, const CellDrawing &cell) {
	const bool is_cut = cell.drawn_count < visible_prefix(ranks, cell.density * first_fraction);
	const std::size_t count = visible_prefix(ranks, cell.density * fraction);
	return is_cut ? std::min(count, cell.drawn_count) : count;
}

} // namespace thicket
