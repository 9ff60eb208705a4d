#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// The parts of a frame's time on the main thread.
enum class FramePart : std::uint8_t {
	follow,     ///< Applying changes of the ground, the layers and the settings.
	gameplay,   ///< The state's clock, and the objects around bodies.
	made,       ///< Taking finished tiles from workers.
	wanted,     ///< Requesting and dropping tiles as viewers move.
	ask_ground, ///< From here on as ScatterStream::Step.
	upload,
	free,
	lod,
	divide,
	fade,
	rings,
	recheck,
	told,    ///< Answering requests, showing scenes, and emitting changes.
	patched, ///< Redrawing tiles that a game has changed.
	signals,
	count,
};

/// Measures the time of each part. Main thread only.
class FrameTimes {
public:
	using Clock = std::chrono::steady_clock;

	/// Starts a new frame.
	void begin() {
		parts_.fill({});
		lap_ = Clock::now();
	}

	/// Counts the time since the last call as spent on a part.
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
