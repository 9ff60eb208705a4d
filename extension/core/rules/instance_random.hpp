#pragma once

#include "core/base/philox.hpp"

#include <array>
#include <cstdint>

namespace thicket {

/// What an instance's random bits are for. Every purpose has words of its own, so that a change in how one is used
/// leaves all others as they were.
enum class Draw : std::uint32_t {
	placement = 1, ///< Words: yaw, scale, tilt, direction of the tilt.
	mesh = 2,      ///< Words: mesh, variation, wind phase, color.
};

/// The key is not the sampler's own, so the words have nothing to do with where the point lies.
constexpr std::uint64_t placement_key(std::uint64_t seed) {
	constexpr std::uint64_t other_than_sampler = 0x9fb21c651e98df25;
	return seed ^ other_than_sampler;
}

/// Four words of 32 random bits that belong to an instance for ever: a function of the set's seed, the packed id and
/// the purpose.
constexpr std::array<std::uint32_t, 4> instance_random(std::uint64_t seed, std::uint64_t id, Draw draw) {
	const std::uint64_t key = placement_key(seed);
	return philox4x32(
			{static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32), static_cast<std::uint32_t>(draw), 0},
			{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
}

/// A word as a number in [0, 1), all 32 bits of it.
constexpr double unit_interval(std::uint32_t word) { return word * 0x1p-32; }

} // namespace thicket
