#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace thicket {

/// For each subset of eight places (one bit each), the first four places in the subset. If the
/// subset has fewer, the last place repeats.
inline constexpr auto empty_places = [] {
	std::array<std::array<std::uint8_t, 4>, 256> table{};
	for (std::uint32_t empty = 1; empty < 256; ++empty) {
		std::uint32_t rest = empty;
		for (std::uint8_t &place : table[empty]) {
			place = static_cast<std::uint8_t>(std::countr_zero(rest));
			rest = (rest & (rest - 1)) != 0 ? rest & (rest - 1) : rest;
		}
	}
	return table;
}();

/// For each subset of eight places, the number of its places that precede each place.
alignas(64) inline constexpr auto places_before = [] {
	std::array<std::array<std::uint8_t, 8>, 256> table{};
	for (std::uint32_t set = 0; set < 256; ++set) {
		for (std::uint32_t place = 0; place < 8; ++place) {
			table[set][place] = static_cast<std::uint8_t>(std::popcount(set & ((1u << place) - 1)));
		}
	}
	return table;
}();

} // namespace thicket
