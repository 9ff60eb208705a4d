#pragma once

#include "core/state/instance_state.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The changes of one call, as they are told.
struct StateChanges {
	std::vector<InstanceChange> list;

	/// Ids that were changed otherwise while a pending diff was under way: what `list` has of them is not to be told, but `instead`.
	std::vector<std::uint64_t> overruled; ///< Ascending.
	std::vector<InstanceChange> instead;

	bool is_overruled(std::uint64_t id) const {
		return !overruled.empty() && std::ranges::binary_search(overruled, id);
	}

	std::size_t size() const { return list.size() + instead.size(); }

	/// The change of a number below `size`; null for one that is not to be told.
	const InstanceChange *at(std::size_t number) const {
		if (number >= list.size()) {
			return &instead[number - list.size()];
		}
		return is_overruled(list[number].id) ? nullptr : &list[number];
	}

	/// Calls `use(change)` for all that are to be told.
	template <typename Use>
	void for_each(const Use &use) const {
		for (const InstanceChange &change : list) {
			if (!is_overruled(change.id)) {
				use(change);
			}
		}
		for (const InstanceChange &change : instead) {
			use(change);
		}
	}
};

} // namespace thicket
