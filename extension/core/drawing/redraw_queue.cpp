#include "core/drawing/redraw_queue.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

bool RedrawQueue::Marks::meet(std::uint32_t layer, const Rect &rect) const {
	if (is_everything_) {
		return true;
	}
	const auto bound = bounds_.find(layer);
	if (bound == bounds_.end() || !thicket::meet(rect, bound->second)) {
		// A rectangle outside the bounds of all areas touches none of them.
		return false;
	}
	return std::ranges::any_of(
			areas_, [&](const Area &area) { return area.layer == layer && thicket::meet(rect, area.rect); });
}

RedrawQueue::Marks RedrawQueue::take() {
	if (marks_.empty()) {
		return {};
	}
	std::map<std::uint32_t, Rect> bounds;
	for (const auto &[layer, rect] : marks_.areas_) {
		Rect &bound = bounds.try_emplace(layer, rect).first->second;
		bound = united(bound, rect);
	}
	++version_;
	Marks marks = std::exchange(marks_, {});
	marks.bounds_ = std::move(bounds);
	return marks;
}

std::optional<TileKey> RedrawQueue::next_queued() {
	if (queued_tiles_.empty()) {
		return std::nullopt;
	}
	return queued_tiles_.extract(queued_tiles_.begin()).value();
}

void RedrawQueue::clear() {
	marks_ = {};
	queued_tiles_.clear();
}

} // namespace thicket
