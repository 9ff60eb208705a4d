#pragma once

#include "core/base/philox.hpp"

#include <array>
#include <cstdint>

namespace thicket {

/// The purpose of an instance's random bits. Each purpose has its own random words, so changing the
/// use of one purpose's words leaves all other random numbers unchanged.
enum class Draw : std::uint32_t {
	placement = 1, ///< Words: yaw, scale, tilt angle, tilt direction.
	mesh = 2,      ///< Words: mesh, variation, wind phase, color.
	row = 3,       ///< Words: rank, displacement along and across the row. Used only by points of rows.
};

/// Returns the key for instance_random. It differs from the sampler's key, so the words are
/// independent of the point's position.
constexpr std::uint64_t placement_key(std::uint64_t seed) {
	constexpr std::uint64_t other_than_sampler = 0x9fb21c651e98df25;
	return seed ^ other_than_sampler;
}

/// Returns four random 32-bit words for an instance. They depend only on the set's seed, the packed
/// ID and the purpose, so they never change.
constexpr std::array<std::uint32_t, 4> instance_random(std::uint64_t seed, std::uint64_t id, Draw draw) {
	const std::uint64_t key = placement_key(seed);
	return philox4x32(
			{static_cast<std::uint32_t>(id), static_cast<std::uint32_t>(id >> 32), static_cast<std::uint32_t>(draw), 0},
			{static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)});
}

/// Converts a word to a number in [0, 1), using all 32 bits.
constexpr double unit_interval(std::uint32_t word) { return word * 0x1p-32; }

} // namespace thicket
