#pragma once

#include <algorithm>
#include <cstddef>

namespace thicket {

/// Takes the memory for `more` entries of a list: until they are there, adding takes none. It grows by doubling, so that
/// single entries do not move the list each time.
template <typename List>
void reserve_more(List &r_list, std::size_t more) {
	if (r_list.capacity() - r_list.size() < more) {
		r_list.reserve(std::max(r_list.size() + more, 2 * r_list.capacity()));
	}
}

} // namespace thicket
