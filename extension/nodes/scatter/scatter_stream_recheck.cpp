// This file detects unreported ground changes. Every frame, the stream compares a few heights with
// those of visible tiles.

#include "nodes/scatter/scatter_stream.hpp"

#include <algorithm>
#include <optional>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// The maximum number of heights to read per frame.
constexpr std::size_t heights_per_frame = 16;

/// Re-checks may take 1 / budget_divisor of a frame's budget on average.
constexpr int budget_divisor = 16;

/// Unused time for re-checks accumulates for up to this number of frames.
constexpr int max_saved_frames = 8;

double seconds_now() {
	return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

bool ScatterStream::rechecks() const {
	const Ref<ScatterGround> &ground = ground_.source.ground;
	return ground.is_valid() && ground->rechecks();
}

/// Adds this frame's portion of the time for re-checks. Call it once per frame. If reading a height
/// takes longer than allowed, as in a slow script, the following frames read none.
void ScatterStream::allow_recheck(Clock::duration budget) {
	const Clock::duration time_per_frame = budget / budget_divisor;
	recheck_time_left_ = std::min(recheck_time_left_ + time_per_frame, max_saved_frames * time_per_frame);
	is_recheck_due_ = true;
}

bool ScatterStream::recheck_step() {
	const bool in_physics_frames = ground_.source.ground.is_valid() && ground_.source.ground->needs_physics_frames();
	if (in_physics_frames || !is_recheck_due_) {
		return false;
	}
	return recheck_heights(heights_per_frame) > 0;
}

/// Samples the ground at a few positions and returns their number. Sampling the ground may run a
/// script, which may even free this object.
std::size_t ScatterStream::recheck_heights(std::size_t max_count) {
	is_recheck_due_ = false;
	const bool has_failed = !recheck_failure_.message.is_empty();
	if (has_failed || recheck_time_left_ <= Clock::duration(0) || !ground_.source.is_available() || !rechecks()) {
		return 0;
	}
	const auto affordable_count =
			static_cast<std::size_t>(recheck_time_left_ / std::max(average_height_time_, Clock::duration(1)));
	const std::size_t count = std::clamp<std::size_t>(affordable_count, 1, std::min(max_count, heights_per_frame));
	const Clock::time_point start = Clock::now();
	std::vector<glm::dvec2> positions;
	recheck_.next(seconds_now(), count, positions);
	if (positions.empty()) {
		return 0;
	}
	const std::weak_ptr<const void> lifetime = life_;
	const Ref<ScatterGround> ground = ground_.source.ground;
	std::vector<std::optional<float>> heights(positions.size());
	const Status status = ground->recheck_now(ground_.source.host, positions, heights);
	if (lifetime.expired()) {
		return positions.size();
	}
	figures_.heights_rechecked += positions.size();
	if (status.ok()) {
		recheck_.answer(seconds_now(), heights, ground->recheck_tolerance());
	} else if (ground_.source.is_available()) {
		report_recheck(status);
	}
	const Clock::duration elapsed = Clock::now() - start;
	recheck_time_left_ -= elapsed;
	average_height_time_ += (elapsed / static_cast<int>(positions.size()) - average_height_time_) / 8;
	return positions.size();
}

std::vector<glm::dvec2> ScatterStream::take_ground_changes() { return recheck_.take_changes(seconds_now()); }

} // namespace thicket
