#pragma once

#include "core/base/instance_id.hpp"
#include "core/base/split_mix.hpp"

#include <cstdint>

namespace thicket {

/// Returns the ID for a new hand-placed instance, among the 2^48 IDs that begin with `prefix`:
/// `first` if it is free, otherwise a free ID that follows a taken one. If the taken IDs after
/// `first` have no gap, the result is the next free ID. It depends only on the set of taken IDs.
/// The search doubles its step until an ID is free, then bisects, so that any number of equal
/// instances takes at most 100 calls to `taken(id)`.
template <typename Taken>
std::uint64_t free_id(std::uint64_t prefix, std::uint64_t first, const Taken &taken) {
	constexpr std::uint64_t no_id = ~std::uint64_t{0};
	const auto is_taken = [&](std::uint64_t step) {
		const std::uint64_t id = prefix | ((first + step) & id_cell_mask);
		return id == no_id || taken(id);
	};
	for (; is_taken(0); first = split_mix(first) & id_cell_mask) {
		std::uint64_t free = 1;
		while (free <= id_cell_mask && is_taken(free)) {
			free *= 2;
		}
		std::uint64_t last_taken = free / 2;
		if (free == 1) {
			last_taken = 0;
		}
		while (free <= id_cell_mask && free - last_taken > 1) {
			const std::uint64_t middle = last_taken + (free - last_taken) / 2;
			(is_taken(middle) ? last_taken : free) = middle;
		}
		if (free <= id_cell_mask) {
			return prefix | ((first + free) & id_cell_mask);
		}
	}
	return prefix | (first & id_cell_mask);
}

} // namespace thicket
