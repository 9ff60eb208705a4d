#pragma once

#include "core/base/rect.hpp"
#include "core/state/state_record.hpp"

#include <cstdint>
#include <map>

namespace thicket {

/// A summary of a diff's content, for inspection before it is applied.
struct DiffSummary {
	/// The part of the content that belongs to one layer.
	struct Layer {
		std::uint64_t removed = 0; ///< Removed points.
		/// Points that are not removed: restored, or listed only for their data.
		std::uint64_t present = 0;
		std::uint64_t added = 0;          ///< Hand-placed instances that exist.
		std::uint64_t removed_placed = 0; ///< Hand-placed instances that no longer exist.
		std::uint64_t with_data = 0;      ///< Instances with data.
		std::uint64_t data_bytes = 0;     ///< Total size of this data in bytes.
		/// World meters. Contains all known positions of instances and cells of points.
		Rect bounds{};
		bool has_bounds = false; ///< True if at least one cell or position is known.
		/// True if all cells and positions are known. Cells of points are known only for claimed
		/// layers; see InstanceState::claim.
		bool has_all_bounds = true;
	};

	bool replaces_everything = false;
	double time = 0.0; ///< The sender's clock.
	StateOrigin origin;
	/// Number of IDs. For a rejected diff in format 1, it counts only the removed points.
	std::uint64_t changes = 0;
	std::map<std::uint16_t, Layer> layers; ///< Empty if the diff was rejected.
};

} // namespace thicket
