#pragma once

#include "core/base/rect.hpp"
#include "core/state/state_record.hpp"

#include <cstdint>
#include <map>

namespace thicket {

/// The content of a diff, read before it is applied.
struct DiffSummary {
	/// Its content for one layer.
	struct Layer {
		std::uint64_t removed = 0;    ///< Points.
		std::uint64_t standing = 0;   ///< Points that are restored or only have data.
		std::uint64_t added = 0;      ///< Hand-placed instances that exist.
		std::uint64_t gone = 0;       ///< Hand-placed instances that no longer exist.
		std::uint64_t with_data = 0;  ///< Instances.
		std::uint64_t data_bytes = 0; ///< Total bytes of these data.
		Rect bounds{};                ///< World meters, around cells of points and positions of instances.
		bool has_bounds = false;      ///< True if any position is known.
		bool has_all_bounds = true;   ///< True if all are known. Points need a claimed layer for this.
	};

	bool replaces_everything = false;
	double time = 0.0; ///< The sender's clock.
	StateOrigin origin;
	std::uint64_t changes = 0;             ///< Ids in it. After a refusal of a format 1 diff, only the removed ids.
	std::map<std::uint16_t, Layer> layers; ///< Empty after a refusal.
};

} // namespace thicket
