#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// How points are arranged along lines, or in parallel rows over areas. Lengths are in meters.
struct RowSettings {
	double step = 2.0; ///< Distance between the points of a row, measured along the line; min_row_step to max_row_step.
	/// Lateral distances of the rows from their line, |offset| <= max_row_offset. Positive values are on
	/// the right, as seen in the direction of the line. Unused if `fills_areas` is true.
	std::vector<double> offsets{0.0};
	/// Largest random displacement along and across the row, 0 to max_row_jitter.
	double jitter_along = 0.0;
	double jitter_across = 0.0;
	/// True if each line is the outline of an area, which is filled with parallel rows.
	bool fills_areas = false;
	double row_distance = 2.0;      ///< Distance between parallel rows; min_row_step to max_row_step.
	double row_angle_degrees = 0.0; ///< Direction of parallel rows relative to RowLine::axis; -360 to 360.
	/// Distance from the crossings of lines within which there are no points, 0 to max_crossing_gap.
	/// Unused if `fills_areas` is true.
	double crossing_gap = 0.0;
	bool turns_instances = true; ///< True if the yaw of instances is relative to the direction of their row.

	friend bool operator==(const RowSettings &, const RowSettings &) = default;
};

inline constexpr double min_row_step = 0.05;
inline constexpr double max_row_step = 1e4;
inline constexpr double max_row_offset = 1e3;
inline constexpr double max_row_jitter = 100.0;
inline constexpr double max_crossing_gap = 1e3;
inline constexpr std::size_t max_row_offsets = 64;
inline constexpr double max_row_coordinate = 1e7; ///< Limit for the coordinates of lines, in world meters.

/// Limits of the numbers that an ID contains (see RowSet). A line has at most max_row_points points in
/// each of its rows. In an area, rows and points are numbered from the anchor in both directions.
inline constexpr std::int64_t max_row_points = 1 << 16;
inline constexpr std::int64_t max_area_rows = 1 << 14;
inline constexpr std::size_t max_row_lines = 1 << 16;

/// A line of a RowSet: a polyline on the plane of world x and z.
struct RowLine {
	/// Identifies the line in the IDs of its points, for example a hash of its name. The points keep
	/// their IDs as long as this number stays the same. Two lines should not have the same number.
	std::uint64_t identity = 0;
	/// A line whose first and last points are equal is closed. Lines of fewer than two different points
	/// have no rows.
	std::vector<glm::dvec2> points{};
	glm::dvec2 anchor{0.0};    ///< The position from which the rows of an area are counted.
	glm::dvec2 axis{1.0, 0.0}; ///< The direction of the rows of an area at an angle of 0; a unit vector.

	friend bool operator==(const RowLine &, const RowLine &) = default;
};

using SharedRowLine = std::shared_ptr<const RowLine>;

/// Returns an error if a setting is out of range.
Status validate(const RowSettings &settings);

/// Returns the radius of a point set with about as many points per area as the rows have where they
/// are dense. Estimates of costs use it.
double equivalent_radius(const RowSettings &settings);

/// Returns the vector to the right of a direction, as seen from above.
inline glm::dvec2 right_of(glm::dvec2 direction) { return {-direction.y, direction.x}; }

/// A row ends with a point if the end of its line is at most this many meters before it, because the
/// length of the line is rounded.
inline constexpr double row_end_tolerance = 1e-6;

} // namespace thicket
