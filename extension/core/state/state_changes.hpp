#pragma once

#include "core/state/instance_state.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The reported changes of one call.
struct StateChanges {
	std::vector<InstanceChange> list;

	/// Ids that were also changed by other calls while a diff was pending. For these, `instead` is reported, not the changes in `list`.
	std::vector<std::uint64_t> overruled; ///< Ascending.
	std::vector<InstanceChange> instead;

	bool is_overruled(std::uint64_t id) const {
		return !overruled.empty() && std::ranges::binary_search(overruled, id);
	}

	std::size_t size() const { return list.size() + instead.size(); }

	/// The change with a number below `size`. Null if the change must not be reported.
	const InstanceChange *at(std::size_t number) const {
		if (number >= list.size()) {
			return &instead[number - list.size()];
		}
		return is_overruled(list[number].id) ? nullptr : &list[number];
	}

	/// Calls `use(change)` for all changes to report.
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
