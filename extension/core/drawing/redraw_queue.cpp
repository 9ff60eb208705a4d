#include "core/drawing/redraw_queue.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <utility>

namespace thicket {

bool RedrawQueue::Marks::meet(std::uint32_t layer, const Rect &rect) const {
	if (all_) {
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
		bound = {glm::min(bound.min, rect.min), glm::max(bound.max, rect.max)};
	}
	++version_;
	Marks taken = std::exchange(marks_, {});
	taken.bounds_ = std::move(bounds);
	return taken;
}

std::optional<TileKey> RedrawQueue::next_later() {
	if (later_.empty()) {
		return std::nullopt;
	}
	return later_.extract(later_.begin()).value();
}

void RedrawQueue::clear() {
	marks_ = {};
	later_.clear();
}

} // namespace thicket
