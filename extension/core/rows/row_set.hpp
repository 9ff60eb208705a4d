#pragma once

#include "core/base/bvh.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rows/row_crossings.hpp"
#include "core/rules/outline.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
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

/// Returns an error if a setting is out of range.
Status validate(const RowSettings &settings);

/// Returns the radius of a point set with about as many points per area as the rows have where they
/// are dense. Estimates of costs use it.
double equivalent_radius(const RowSettings &settings);

/// The points of all rows along a number of lines, which a layer uses instead of a Poisson-disk set.
/// Each point has a number within its row: its distance from the start of the line in steps or, in an
/// area, from the anchor. The ID of a point contains the line, the row and this number. Position and ID
/// of a point therefore do not depend on the queried rectangle, and the ID does not depend on other
/// lines. If a line is edited, the points before the edited place keep their positions, and the points
/// after it keep their IDs and move along the line.
///
/// The line has 18 bits of an ID, taken from RowLine::identity. If these bits are equal for two lines,
/// the line with the greater identity gets the next free number.
///
/// A set is immutable once it is shared, so any number of threads may read it.
class RowSet {
public:
	/// Sets the content. Returns an error that names the property if the settings are invalid, if a
	/// coordinate of a line is not finite or too large, or if a line has too many points for their IDs.
	/// The names of errors that depend on lines begin with "rows.".
	/// The set is then unchanged. Takes O(n log n) time for n points of lines.
	Status set(const RowSettings &settings, std::vector<RowLine> lines);

	const RowSettings &settings() const { return settings_; }
	std::span<const RowLine> lines() const { return lines_; }

	/// Returns the number of a line in the IDs of its points.
	std::uint32_t key(std::size_t line) const { return keys_[line]; }

	/// Appends the points in `rect`, in no particular order. `set` provides the seed and the layer, from
	/// which random displacements and ranks are derived. Takes O(p + log n) time for p points and n
	/// points of lines. Returns ErrorCode::cancelled about a millisecond after `cancel` is set, and
	/// ErrorCode::too_many_points if there are more points than one call may return. Throws std::bad_alloc.
	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const std::atomic<bool> *cancel = nullptr) const;

	/// Returns the position of a point in world meters; no value if the set has no point with this ID.
	std::optional<glm::dvec2> position(const PointSet &set, std::uint64_t id) const;

	/// Returns the yaw that turns an instance's negative z axis into the direction of its row, or no
	/// rotation if the set has no such row.
	Rotation heading(std::uint64_t id) const;

	/// Largest distance in meters of a point from its line.
	double reach() const;

private:
	/// The place of a point, as its ID contains it.
	struct Place {
		std::uint32_t line = 0;
		std::int64_t row = 0;
		std::int64_t step = 0;
	};

	/// The part of a row between two points of its line.
	struct Spot {
		glm::dvec2 position;
		glm::dvec2 direction; ///< A unit vector.
	};

	/// Data of a line that are computed once.
	struct Course {
		std::vector<glm::dvec2> points; ///< Without repetitions.
		std::vector<double> lengths;    ///< Distance from the start to each point, along the line.
		std::int64_t count = 0;         ///< Number of points in each row along the line.
		Outline outline;
		Rect bounds;
		glm::dvec2 direction{1.0, 0.0}; ///< Direction of the rows of an area.
	};

	struct Segment {
		std::uint32_t line;
		std::uint32_t first; ///< Index of the first of the segment's two points.
	};

	class Collector;

	Status add_course(const RowLine &line, std::vector<Course> &r_courses) const;
	void assign_keys();
	void index_segments();
	void find_crossings();
	RowSegment ends_of(const Segment &segment) const;
	bool are_consecutive(const Segment &a, const Segment &b) const;
	template <class Visit>
	void visit_segments(const Rect &rect, const Visit &visit) const;
	std::uint64_t id_of(const PointSet &set, const Place &place) const;
	std::optional<Place> place_of(std::uint64_t id) const;
	std::size_t segment_at(const Course &course, std::int64_t step) const;
	Spot spot_at(const Course &course, std::size_t segment, std::int64_t step) const;
	std::optional<glm::dvec2> position_of(
			const PointSet &set, const Place &place, std::size_t segment, std::uint64_t id) const;
	std::optional<glm::dvec2> position_in_area(const PointSet &set, const Place &place, std::uint64_t id) const;
	glm::dvec2 displaced(const PointSet &set, std::uint64_t id, const Spot &spot) const;

	RowSettings settings_;
	std::vector<RowLine> lines_;
	std::vector<Course> courses_;       ///< For each line.
	std::vector<std::uint32_t> keys_;   ///< The number of each line in IDs.
	std::vector<std::uint32_t> by_key_; ///< Indices of the lines, by ascending key.
	std::vector<Segment> segments_;     ///< In the order of the tree.
	Bvh tree_;
	std::vector<Rect> boxes_; ///< Bounds of the tree's nodes.
	RowCrossings crossings_;
};

} // namespace thicket
