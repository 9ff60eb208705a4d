#pragma once

#include "core/base/instance_id.hpp"
#include "core/rows/row_line.hpp"

#include <algorithm>
#include <cstdint>

namespace thicket {

// The 48 bits of a place in an ID, from the highest: the upper bits of the line, the row, the lower bits
// of the line, and the step. Nearby points of an area thus have nearby values in both halves.
inline constexpr int row_step_bits = 16;
inline constexpr int row_number_bits = 14;
inline constexpr int low_row_line_bits = 8;
inline constexpr int row_line_bits = 18;
static_assert(row_step_bits + row_number_bits + row_line_bits == id_layer_shift);
static_assert(max_row_points == 1 << row_step_bits && max_area_rows == 1 << row_number_bits);

/// Rows and steps of an area are counted from these numbers, so that IDs contain no negative ones.
inline constexpr std::int64_t middle_row = max_area_rows / 2;
inline constexpr std::int64_t middle_step = max_row_points / 2;

/// Returns a number as an integer within limits.
inline std::int64_t limited(double value, std::int64_t min, std::int64_t max) {
	return static_cast<std::int64_t>(std::clamp(value, static_cast<double>(min), static_cast<double>(max)));
}

} // namespace thicket
