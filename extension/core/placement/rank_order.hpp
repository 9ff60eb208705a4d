#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A key for sorting points: the rank, and the index of the point.
constexpr std::uint64_t rank_key(std::uint32_t rank, std::size_t index) { return std::uint64_t{rank} << 32 | index; }

/// The index in a key.
constexpr std::uint32_t point_of(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

/// Sorts keys by rank, and keys of equal rank by the id of their point, so the result does not depend on the order of the points. `scratch`
/// is working memory that is reused by later calls. O(n): a radix sort, about eight times as fast as std::sort on the keys of one tile.
void sort_by_rank(
		std::vector<std::uint64_t> &keys, std::span<const std::uint64_t> ids, std::vector<std::uint64_t> &scratch);

} // namespace thicket
