#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// What a frame's time on the main thread went to.
enum class FramePart : std::uint8_t {
	follow,     ///< Changes of the ground, the layers and the settings taken in.
	gameplay,   ///< The state's clock, and what stands around bodies.
	made,       ///< Tiles taken over from workers.
	wanted,     ///< Tiles asked for and dropped as viewers move.
	ask_ground, ///< From here on as ScatterStream::Step.
	upload,
	free,
	lod,
	divide,
	fade,
	rings,
	recheck,
	told,    ///< Requests answered, scenes shown, changes told.
	patched, ///< Tiles drawn anew that a game has changed.
	signals,
	count,
};

/// A stopwatch with a hand for each part. Main thread only.
class FrameTimes {
public:
	using Clock = std::chrono::steady_clock;

	/// A new frame begins.
	void begin() {
		parts_.fill({});
		lap_ = Clock::now();
	}

	/// What has passed since the last call was spent on a part.
	void spent_on(FramePart part) {
		const Clock::time_point now = Clock::now();
		parts_[static_cast<std::size_t>(part)] += now - lap_;
		lap_ = now;
	}

	std::int64_t microseconds(FramePart part) const {
		return std::chrono::duration_cast<std::chrono::microseconds>(parts_[static_cast<std::size_t>(part)]).count();
	}

private:
	std::array<Clock::duration, static_cast<std::size_t>(FramePart::count)> parts_{};
	Clock::time_point lap_;
};

} // namespace thicket
