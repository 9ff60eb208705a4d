#pragma once

#include <cstdint>

namespace thicket {

/// Returns the number of bits that are set. Unlike std::popcount, this never compiles to a
/// library call.
constexpr std::uint32_t count_bits(std::uint64_t bits) {
	bits -= bits >> 1 & 0x5555555555555555u;
	bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
	bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
	return static_cast<std::uint32_t>(bits * 0x0101010101010101u >> 56);
}

} // namespace thicket
