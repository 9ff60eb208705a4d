#pragma once

#include "core/base/philox.hpp"

#include <array>
#include <cstdint>

namespace thicket {

/// The purpose of an instance's random bits. Each purpose has its own words, so a change in the use of one leaves all others unchanged.
enum class Draw : std::uint32_t {
	placement = 1, ///< Words: yaw, scale, tilt, direction of the tilt.
	mesh = 2,      ///< Words: mesh, variation, wind phase, color.
};

/// Different from the sampler's own key, so the words are independent of the point's position.
constexpr std::uint64_t placement_key(std::uint64_t seed) {
	constexpr std::uint64_t other_than_sampler = 0x9fb21c651e98df25;
	return seed ^ other_than_sampler;
}

/// Four words of 32 random bits that permanently belong to an instance: a function of the set's seed, the packed id and the purpose.
constexpr std::array<std::uint32_t, 4> instance_random(std::uint64_t seed, std::uint64_t id, Draw draw) {
	const std::uint64_t key = placement_key(seed);
	return philox4x32(
			{static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32), static_cast<std::uint32_t>(draw), 0},
			{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
}

/// A word as a number in [0, 1), using all 32 bits.
constexpr double unit_interval(std::uint32_t word) { return word * 0x1p-32; }

} // namespace thicket
