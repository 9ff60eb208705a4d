#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

inline constexpr std::size_t max_instance_data = 65536; ///< Bytes an instance.

/// Bounds on what a diff may do to the state of its receiver. The defaults suit a client that follows its server.
struct DiffLimits {
	std::uint64_t max_changes = std::uint64_t{1} << 21;       ///< Ids that one diff names.
	std::uint64_t max_total_changes = std::uint64_t{1} << 24; ///< Removed, hand-placed and data, held after it.
	std::uint64_t max_added = std::uint64_t{1} << 20;         ///< Hand-placed instances, held after it.
	std::uint64_t max_data_size = max_instance_data;          ///< Bytes an instance.
	Rect area{};                                              ///< World meters; empty for no bound.
	bool allow_replacement = true;                            ///< One diff may replace everything.
	double max_clock_advance = 60.0; ///< Seconds that a diff of some ids moves the clock, at most.

	/// Refuses no diff. The clock still moves by at most its default.
	static DiffLimits none();
};

// Refusals have ErrorCode::not_allowed, that of `missing_before` ErrorCode::out_of_order.

/// Refuses more than `most` of something. `limit` is a string literal that names the limit.
Status check_limit(const char *what, std::uint64_t value, std::uint64_t most, const char *limit);

/// Refuses a diff that replaces everything.
Status refused_replacement();

/// Refuses a position outside of the area, by the axis that is worse.
Status check_area(const DiffLimits &limits, const Rect &place);

/// Refuses a layer whose points have no known position.
Status unknown_cells(std::uint16_t layer);

/// Refuses a diff that starts at a revision of its sender after `known`, the last that was received.
Status missing_before(std::uint64_t base, std::uint64_t known);

} // namespace thicket
