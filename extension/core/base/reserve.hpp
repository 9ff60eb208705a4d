#pragma once

#include <algorithm>
#include <cstddef>

namespace thicket {

/// Reserves memory for `more` additional entries of a list, so that adding them does not allocate.
/// If the capacity grows, it at least doubles, so that repeated small requests do not reallocate
/// each time.
template <typename List>
void reserve_more(List &r_list, std::size_t more) {
	if (r_list.capacity() - r_list.size() < more) {
		r_list.reserve(std::max(r_list.size() + more, 2 * r_list.capacity()));
	}
}

} // namespace thicket
