#include "core/drawing/draw_budget.hpp"

#include "core/placement/tile_instances.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

DrawAmounts &DrawAmounts::operator+=(const DrawAmounts &other) {
	instances += other.instances;
	bytes += other.bytes;
	multimeshes += other.multimeshes;
	drawn += other.drawn;
	wanted += other.wanted;
	return *this;
}

DrawAmounts &DrawAmounts::operator-=(const DrawAmounts &other) {
	instances -= other.instances;
	bytes -= other.bytes;
	multimeshes -= other.multimeshes;
	drawn -= other.drawn;
	wanted -= other.wanted;
	return *this;
}

bool DrawBudget::begin_frame() {
	const double share = limited_share(share_, amounts_.wanted, next_limits_.max_instances);
	if (share == share_ && next_limits_ == limits_) {
		return false;
	}
	share_ = share;
	limits_ = next_limits_;
	return true;
}

bool DrawBudget::draw(
		std::uint32_t layer, double look_share, std::span<const std::uint32_t> ranks, CellDrawing &r_cell) {
	const double unlimited = r_cell.thinned * limits_.share(layer);
	r_cell.density = unlimited * share_;
	amounts_.wanted -= std::exchange(r_cell.wanted, visible_prefix(ranks, unlimited * look_share));
	amounts_.wanted += r_cell.wanted;
	amounts_.drawn -= r_cell.drawn;
	const std::size_t due = visible_prefix(ranks, r_cell.density * look_share);
	const std::uint64_t room = limits_.max_instances - std::min(limits_.max_instances, amounts_.drawn);
	r_cell.drawn = static_cast<std::size_t>(std::min<std::uint64_t>(due, room));
	amounts_.drawn += r_cell.drawn;
	return r_cell.drawn == due;
}

std::set<TileKey, TileKeyOrder> DrawBudget::take_cut() { return std::exchange(cut_, {}); }

void DrawBudget::clear() {
	amounts_ = {};
	share_ = 1.0;
	cut_.clear();
}

} // namespace thicket
