#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace thicket {

/// For each subset of eight entries (one bit each), the first four entries in the subset. If the
/// subset has fewer, the last entry repeats.
inline constexpr auto empty_entries = [] {
	std::array<std::array<std::uint8_t, 4>, 256> table{};
	for (std::uint32_t empty = 1; empty < 256; ++empty) {
		std::uint32_t rest = empty;
		for (std::uint8_t &entry : table[empty]) {
			entry = static_cast<std::uint8_t>(std::countr_zero(rest));
			rest = (rest & (rest - 1)) != 0 ? rest & (rest - 1) : rest;
		}
	}
	return table;
}();

/// For each subset of eight entries, the number of its entries that precede each entry.
alignas(64) inline constexpr auto entries_before = [] {
	std::array<std::array<std::uint8_t, 8>, 256> table{};
	for (std::uint32_t set = 0; set < 256; ++set) {
		for (std::uint32_t entry = 0; entry < 8; ++entry) {
			table[set][entry] = static_cast<std::uint8_t>(std::popcount(set & ((1u << entry) - 1)));
		}
	}
	return table;
}();

} // namespace thicket
