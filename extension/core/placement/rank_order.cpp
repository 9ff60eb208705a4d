#include "core/placement/rank_order.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace thicket {

namespace {

/// Three digits of 11 bits cover the upper 32 bits. The 2,048 counters per digit fit in the L1
/// cache.
constexpr std::array<int, 3> shifts{32, 43, 54};
constexpr std::size_t digit_values = 1 << 11;

/// For fewer keys than this, clearing the counters costs more than sorting.
constexpr std::size_t few = 128;

std::size_t digit(std::uint64_t key, int shift) { return key >> shift & (digit_values - 1); }

/// Sorts by rank only. Keys of equal rank keep their order.
void radix_sort(std::vector<std::uint64_t> &keys, std::vector<std::uint64_t> &scratch) {
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

} // namespace

void sort_by_rank(
		std::vector<std::uint64_t> &keys, std::span<const std::uint64_t> ids, std::vector<std::uint64_t> &scratch) {
	if (keys.size() < few) {
		// For few keys, a comparison sort is faster.
		std::sort(keys.begin(), keys.end());
	} else {
		// The radix sort produces the same order of ranks as the comparison sort.
		radix_sort(keys, scratch);
	}
	const auto shares_rank = [](std::uint64_t a, std::uint64_t b) {
		return a >> 32 == b >> 32;
	};
	const auto lower_id = [ids](std::uint64_t a, std::uint64_t b) {
		return ids[point_of(a)] < ids[point_of(b)];
	};
	for (auto first = std::adjacent_find(keys.begin(), keys.end(), shares_rank); first != keys.end();) {
		const auto last = std::find_if(first, keys.end(), [&](std::uint64_t key) { return !shares_rank(*first, key); });
		std::sort(first, last, lower_id);
		first = std::adjacent_find(last, keys.end(), shares_rank);
	}
}

} // namespace thicket
