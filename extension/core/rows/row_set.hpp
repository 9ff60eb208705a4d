#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rows/row_course.hpp"
#include "core/rows/row_crossings.hpp"
#include "core/rows/row_line.hpp"
#include "core/rows/row_tree.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

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

	/// Like `set`, for lines that are already shared; no pointer may be null. Takes the data of unchanged
	/// lines from `former`, a set that may be null. The time is then proportional to the number of lines
	/// and to the points of the changed ones. `former` has no effect on the content.
	Status set_shared(const RowSettings &settings, std::vector<SharedRowLine> lines, const RowSet *former = nullptr);

	const RowSettings &settings() const { return settings_; }
	std::size_t line_count() const { return courses_.size(); }
	const SharedRowLine &line(std::size_t index) const { return courses_[index]->line(); }

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

	using Spot = RowCourse::Spot;

	/// A position at which two lines cross, or a line crosses itself.
	struct Crossing {
		std::uint32_t a = 0; ///< Index of a line.
		std::uint32_t b = 0;
		glm::dvec2 position{0.0};
	};

	class Collector;

	Status add_courses(const std::vector<SharedRowLine> &lines, const RowSet *former);
	const SharedRowCourse *find_course(const SharedRowLine &line, std::size_t index) const;
	void assign_keys(const RowSet *former);
	void index_courses();
	void find_crossings(const RowSet *former);
	void add_former_crossings(const RowSet &former, std::vector<bool> &r_known);
	void add_crossings(std::uint32_t one, std::uint32_t other);
	/// Returns the distance of a step from the start of its line, or from the anchor.
	double along(std::int64_t step) const { return static_cast<double>(step) * settings_.step; }
	std::uint64_t id_of(const PointSet &set, const Place &place) const;
	std::optional<Place> place_of(std::uint64_t id) const;
	std::optional<glm::dvec2> position_of(
			const PointSet &set, const Place &place, std::size_t segment, std::uint64_t id) const;
	std::optional<glm::dvec2> position_in_area(const PointSet &set, const Place &place, std::uint64_t id) const;
	glm::dvec2 displaced(const PointSet &set, std::uint64_t id, const Spot &spot) const;

	RowSettings settings_;
	std::vector<SharedRowCourse> courses_;   ///< For each line.
	std::vector<std::uint32_t> keys_;        ///< The number of each line in IDs.
	std::vector<std::uint32_t> by_key_;      ///< Indices of the lines, by ascending key.
	std::vector<std::uint32_t> by_identity_; ///< Indices of the lines, by ascending identity.
	RowTree tree_;                           ///< The lines that have rows.
	std::vector<Crossing> crossings_of_lines_;
	RowCrossings crossings_;
};

} // namespace thicket
