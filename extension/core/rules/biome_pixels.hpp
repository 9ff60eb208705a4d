#pragma once

// The parts of a biome map that planes and planets share.

#include "core/rules/biome_map.hpp"

#include <glm/vec2.hpp>

#include <array>

namespace thicket {

/// Edge length of a block of a biome map, in pixels.
inline constexpr int biome_block = 8;

/// Tap offsets in units of the border width: the Hammersley set of 16 points. The points cover the
/// square evenly, and no two points share a coordinate, so a straight border along an axis is
/// resolved into 16 equal steps.
inline constexpr std::array<glm::dvec2, biome_taps> biome_tap_offsets = [] {
	std::array<glm::dvec2, biome_taps> offsets{};
	for (unsigned i = 0; i < biome_taps; ++i) {
		const unsigned reversed = (i & 1U) << 3U | (i & 2U) << 1U | (i & 4U) >> 1U | (i & 8U) >> 3U;
		offsets[i] = {(i + 0.5) / biome_taps - 0.5, (reversed + 0.5) / biome_taps - 0.5};
	}
	return offsets;
}();

/// Returns the integer part of `value`, clamped to [0, count - 1], or 0 for NAN.
inline int held_index(double value, int count) {
	if (!(value > 0.0)) {
		return 0;
	}
	return value < static_cast<double>(count) ? static_cast<int>(value) : count - 1;
}

} // namespace thicket
