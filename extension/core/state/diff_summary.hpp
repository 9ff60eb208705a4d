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
		std::uint64_t standing = 0;   ///< Points that are restored, or have data only.
		std::uint64_t added = 0;      ///< Hand-placed instances that are there.
		std::uint64_t gone = 0;       ///< Hand-placed instances that are not there any more.
		std::uint64_t with_data = 0;  ///< Instances.
		std::uint64_t data_bytes = 0; ///< Bytes of these data.
		Rect bounds{};                ///< World meters, around cells of points and positions of hand-placed ones.
		bool has_bounds = false;      ///< True if any position is known.
		bool has_all_bounds = true;   ///< True if all are: those of points need a claimed layer.
	};

	bool replaces_everything = false;
	double time = 0.0; ///< The sender's clock.
	StateOrigin origin;
	std::uint64_t changes =
			0; ///< Ids that it names. After a refusal of a diff of format 1 only those that are removed.
	std::map<std::uint16_t, Layer> layers; ///< Empty after a refusal.
};

} // namespace thicket
