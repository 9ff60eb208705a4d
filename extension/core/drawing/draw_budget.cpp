#include "core/drawing/draw_budget.hpp"

#include "core/placement/tile_instances.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

DrawAmounts &DrawAmounts::operator+=(const DrawAmounts &other) {
	instances += other.instances;
	bytes += other.bytes;
	multimeshes += other.multimeshes;
	drawn_count += other.drawn_count;
	wanted_count += other.wanted_count;
	return *this;
}

DrawAmounts &DrawAmounts::operator-=(const DrawAmounts &other) {
	instances -= other.instances;
	bytes -= other.bytes;
	multimeshes -= other.multimeshes;
	drawn_count -= other.drawn_count;
	wanted_count -= other.wanted_count;
	return *this;
}

bool DrawBudget::begin_frame() {
	const double fraction = limited_fraction(fraction_, amounts_.wanted_count, next_limits_.max_instances);
	if (fraction == fraction_ && next_limits_ == limits_) {
		return false;
	}
	fraction_ = fraction;
	limits_ = next_limits_;
	return true;
}

bool DrawBudget::draw(
		std::uint32_t layer, double lod_density, std::span<const std::uint32_t> ranks, CellDrawing &r_cell) {
	const double unlimited_density = r_cell.remaining_fraction * limits_.fraction(layer);
	r_cell.density = unlimited_density * fraction_;
	amounts_.wanted_count -= std::exchange(r_cell.wanted_count, visible_prefix(ranks, unlimited_density * lod_density));
	amounts_.wanted_count += r_cell.wanted_count;
	amounts_.drawn_count -= r_cell.drawn_count;
	const std::size_t count = visible_prefix(ranks, r_cell.density * lod_density);
	const std::uint64_t available_count = limits_.max_instances - std::min(limits_.max_instances, amounts_.drawn_count);
	r_cell.drawn_count = static_cast<std::size_t>(std::min<std::uint64_t>(count, available_count));
	amounts_.drawn_count += r_cell.drawn_count;
	return r_cell.drawn_count == count;
}

std::set<TileKey, TileKeyOrder> DrawBudget::take_cut() { return std::exchange(cut_tiles_, {}); }

void DrawBudget::clear() {
	amounts_ = {};
	fraction_ = 1.0;
	cut_tiles_.clear();
}

} // namespace thicket
