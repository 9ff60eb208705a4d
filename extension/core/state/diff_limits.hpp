#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

inline constexpr std::size_t max_instance_data = 65536; ///< Bytes per instance.

/// Limits for the effect of a diff on its receiver. The defaults suit a client that follows its server.
struct DiffLimits {
	std::uint64_t max_changes = std::uint64_t{1} << 21;       ///< Ids in one diff.
	std::uint64_t max_total_changes = std::uint64_t{1} << 24; ///< Removed, hand-placed and data entries held after it.
	std::uint64_t max_added = std::uint64_t{1} << 20;         ///< Hand-placed instances held after it.
	std::uint64_t max_data_size = max_instance_data;          ///< Bytes per instance.
	Rect area{};                                              ///< World meters; empty for no limit.
	bool allow_replacement = true;                            ///< Whether one diff may replace everything.
	double max_clock_advance = 60.0; ///< Most seconds by which a diff of some ids moves the clock.

	/// Accepts every diff. The clock still moves by at most its default.
	static DiffLimits none();
};

// Refusals have ErrorCode::not_allowed; `missing_before` has ErrorCode::out_of_order.

/// Refuses a number of things above `most`. `limit` is a string literal with the name of the limit.
Status check_limit(const char *what, std::uint64_t value, std::uint64_t most, const char *limit);

/// Refuses a diff that replaces everything.
Status refused_replacement();

/// Refuses a position outside the area. Reports the axis with the larger deviation.
Status check_area(const DiffLimits &limits, const Rect &place);

/// Refuses a layer whose points have no known position.
Status unknown_cells(std::uint16_t layer);

/// Refuses a diff that starts at a revision of its sender after `known`, the last revision received.
Status missing_before(std::uint64_t base, std::uint64_t known);

} // namespace thicket
