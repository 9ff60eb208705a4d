#pragma once

#include "core/state/instance_state.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The changes to report for one call.
struct StateChanges {
	std::vector<InstanceChange> list;

	/// IDs that other calls changed while a diff was pending. For these IDs, `replacements` are reported,
	/// and their changes in `list` are not.
	std::vector<std::uint64_t> overruled; ///< Ids in ascending order.
	std::vector<InstanceChange> replacements;

	bool is_overruled(std::uint64_t id) const {
		return !overruled.empty() && std::ranges::binary_search(overruled, id);
	}

	std::size_t size() const { return list.size() + replacements.size(); }

	/// Returns the change at index `number`, which must be below `size`, or null if it is overruled
	/// and must not be reported.
	const InstanceChange *at(std::size_t number) const {
		if (number >= list.size()) {
			return &replacements[number - list.size()];
		}
		return is_overruled(list[number].id) ? nullptr : &list[number];
	}

	/// Calls `use(change)` for each change to report.
	template <typename Use>
	void for_each(const Use &use) const {
		for (const InstanceChange &change : list) {
			if (!is_overruled(change.id)) {
				use(change);
			}
		}
		for (const InstanceChange &change : replacements) {
			use(change);
		}
	}
};

} // namespace thicket
