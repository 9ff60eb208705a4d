#include "core/placement/rank_order.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

namespace thicket {

namespace {

/// Three digits cover the upper 32 bits; 2,048 counters a digit stay in the first-level cache.
constexpr std::array<int, 3> shifts{32, 43, 54};
constexpr std::size_t digit_values = 1 << 11;

/// Below this, clearing the counters costs more than sorting.
constexpr std::size_t few = 128;

std::size_t digit(std::uint64_t key, int shift) {
	return key >> shift & (digit_values - 1);
}

} // namespace

void sort_by_upper_half(std::vector<std::uint64_t> &keys, std::vector<std::uint64_t> &scratch) {
	if (keys.size() < few) {
		// An insertion sort is stable and needs no memory, unlike std::stable_sort.
		for (auto key = keys.begin(); key != keys.end(); ++key) {
			const auto above = [](std::uint64_t a, std::uint64_t b) { return a >> 32 < b >> 32; };
			std::rotate(std::upper_bound(keys.begin(), key, *key, above), key, key + 1);
		}
		return;
	}
	std::array<std::array<std::uint32_t, digit_values>, shifts.size()> counts{};
	for (const std::uint64_t key : keys) {
		for (std::size_t pass = 0; pass < shifts.size(); ++pass) {
			++counts[pass][digit(key, shifts[pass])];
		}
	}
	scratch.resize(keys.size());
	for (std::size_t pass = 0; pass < shifts.size(); ++pass) {
		std::uint32_t start = 0;
		for (std::uint32_t &count : counts[pass]) {
			start += std::exchange(count, start);
		}
		for (const std::uint64_t key : keys) {
			scratch[counts[pass][digit(key, shifts[pass])]++] = key;
		}
		keys.swap(scratch);
	}
}

} // namespace thicket
