#include "nodes/drawing/leaving_visuals.hpp"

#include <algorithm>

namespace thicket {

namespace {

/// The maximum number of visuals that one step hides, which takes tens of microseconds.
constexpr std::size_t hidden_per_step = 16;

} // namespace

bool LeavingVisuals::free_step() {
	if (!are_hidden()) {
		const std::size_t end = std::min(visuals_.size(), hidden_count_ + hidden_per_step);
		for (; hidden_count_ < end; ++hidden_count_) {
			visuals_[hidden_count_].set_visible(false);
		}
		return true;
	}
	if (visuals_.empty()) {
		return false;
	}
	visuals_.pop_back();
	hidden_count_ = visuals_.size();
	return true;
}

void LeavingVisuals::set_frame(const WorldFrame &frame) {
	for (TileVisual &visual : visuals_) {
		visual.set_frame(frame);
	}
}

void LeavingVisuals::clear() {
	visuals_.clear();
	hidden_count_ = 0;
}

} // namespace thicket
