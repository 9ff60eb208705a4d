#pragma once

#include <algorithm>
#include <cstddef>

namespace thicket {

/// Allocates the memory for `more` entries of a list, so that adding them allocates nothing. Capacity grows by doubling, so that adding
/// single entries does not move the list each time.
template <typename List>
void reserve_more(List &r_list, std::size_t more) {
	if (r_list.capacity() - r_list.size() < more) {
		r_list.reserve(std::max(r_list.size() + more, 2 * r_list.capacity()));
	}
}

} // namespace thicket
