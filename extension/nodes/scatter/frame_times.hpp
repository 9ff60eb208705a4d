#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// The parts into which a frame's time on the main thread is divided.
enum class FramePart : std::uint8_t {
	follow,         ///< Applying changes to the ground, the layers and the settings.
	gameplay,       ///< Advancing the state's clock, and finding viewers and nearby instances.
	finished_tiles, ///< Taking finished tiles from the workers.
	tile_requests,  ///< Requesting and dropping tiles as viewers move.
	query_ground,   ///< This part and the following ones up to `recheck` are in the order of ScatterStream::Step.
	upload,
	free,
	lod,
	divide,
	fade,
	rings,
	recheck,
	reports, ///< Answering requests, showing scenes, and emitting signals of changes.
	patches, ///< Redrawing tiles that a game has changed.
	signals,
	count,
};

/// Measures the time of each part of a frame. Use it only on the main thread.
class FrameTimes {
public:
	using Clock = std::chrono::steady_clock;

	/// Starts a new frame.
	void begin() {
		parts_.fill({});
		last_time_ = Clock::now();
	}

	/// Adds the time since the last call to `part`.
	void add_time(FramePart part) {
		const Clock::time_point now = Clock::now();
		parts_[static_cast<std::size_t>(part)] += now - last_time_;
		last_time_ = now;
	}

	std::int64_t microseconds(FramePart part) const {
		return std::chrono::duration_cast<std::chrono::microseconds>(parts_[static_cast<std::size_t>(part)]).count();
	}

private:
	std::array<Clock::duration, static_cast<std::size_t>(FramePart::count)> parts_{};
	Clock::time_point last_time_;
};

} // namespace thicket
