#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

inline constexpr std::size_t max_instance_data = 65536; ///< Maximum bytes of data per instance.

/// Limits on what a diff may change in the state that receives it. The defaults suit a client that
/// receives its server's diffs.
struct DiffLimits {
	std::uint64_t max_changes = std::uint64_t{1} << 21; ///< Maximum number of IDs in one diff.
	/// Maximum number of entries in the receiving state after the diff: removed points, hand-placed
	/// instances and data.
	std::uint64_t max_total_changes = std::uint64_t{1} << 24;
	/// Maximum number of hand-placed instances in the receiving state after the diff.
	std::uint64_t max_added = std::uint64_t{1} << 20;
	std::uint64_t max_data_size = max_instance_data; ///< Maximum bytes of data per instance.
	/// Area in world meters in which instances may change. If it is empty, there is no limit.
	Rect area{};
	bool allow_replacement = true;   ///< True if a diff may replace the whole state.
	double max_clock_advance = 60.0; ///< Maximum seconds by which a partial diff advances the clock.

	/// Returns limits that accept every diff. max_clock_advance keeps its default.
	static DiffLimits none();
};

// The errors of the functions below have the code ErrorCode::not_allowed, except that
// `missing_before` returns ErrorCode::out_of_order.

/// Returns an error for a `value` above `max_value`. `what` and `limit` are string literals that
/// name the value and its limit.
Status check_limit(const char *what, std::uint64_t value, std::uint64_t max_value, const char *limit);

/// Returns the error for a diff that replaces the whole state.
Status refused_replacement();

/// Returns an error for a rectangle that does not touch the area. The error reports the x axis if
/// the rectangle is outside along x, and otherwise the z axis.
Status check_area(const DiffLimits &limits, const Rect &changed);

/// Returns the error for a layer whose points have unknown positions.
Status unknown_cells(std::uint16_t layer);

/// Returns the error for a diff that starts at the sender's revision `base`, which is after
/// `known`, the last revision received.
Status missing_before(std::uint64_t base, std::uint64_t known);

} // namespace thicket
