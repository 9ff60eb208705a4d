#pragma once

#include <array>
#include <cstdint>

namespace thicket {

/// Multipliers and Weyl constants of Philox 4x32.
inline constexpr std::uint32_t philox_mul_0 = 0xD2511F53;
inline constexpr std::uint32_t philox_mul_1 = 0xCD9E8D57;
inline constexpr std::uint32_t philox_weyl_0 = 0x9E3779B9;
inline constexpr std::uint32_t philox_weyl_1 = 0xBB67AE85;

/// Seven is the smallest number of rounds with which the generator passes all tests of BigCrush
/// (table 2 of the paper cited below).
inline constexpr int philox_rounds = 7;

/// Returns counter-based random bits: Philox4x32-7 of Salmon, Moraes, Dror and Shaw, "Parallel
/// random numbers: as easy as 1, 2, 3" (2011, section 4). Every output bit depends on all bits of
/// the counter and the key. The function is stateless.
constexpr std::array<std::uint32_t, 4> philox4x32(
		std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
	for (int round = 0; round < philox_rounds; ++round) {
		const std::uint64_t product_0 = std::uint64_t{philox_mul_0} * counter[0];
		const std::uint64_t product_1 = std::uint64_t{philox_mul_1} * counter[2];
		counter = {
				static_cast<std::uint32_t>(product_1 >> 32) ^ counter[1] ^ key[0],
				static_cast<std::uint32_t>(product_1),
				static_cast<std::uint32_t>(product_0 >> 32) ^ counter[3] ^ key[1],
				static_cast<std::uint32_t>(product_0),
		};
		key[0] += philox_weyl_0;
		key[1] += philox_weyl_1;
	}
	return counter;
}

} // namespace thicket
