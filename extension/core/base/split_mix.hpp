#pragma once

#include <cstdint>

namespace thicket {

inline constexpr std::uint64_t split_mix_gamma = 0x9E3779B97F4A7C15;
inline constexpr std::uint64_t split_mix_mul_0 = 0xBF58476D1CE4E5B9;
inline constexpr std::uint64_t split_mix_mul_1 = 0x94D049BB133111EB;

/// Applies the mixing function of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom
/// number generators", 2014, with the constants of Stafford's variant 13). The function is
/// bijective, and each output bit depends on all input bits. To generate a stream, increment the
/// input by split_mix_gamma.
constexpr std::uint64_t split_mix(std::uint64_t bits) {
	bits = (bits ^ bits >> 30) * split_mix_mul_0;
	bits = (bits ^ bits >> 27) * split_mix_mul_1;
	return bits ^ bits >> 31;
}

} // namespace thicket
