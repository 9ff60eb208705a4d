#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rows/row_crossings.hpp"
#include "core/rows/row_line.hpp"
#include "core/rows/row_tree.hpp"
#include "core/rules/outline.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Everything about a line of a RowSet that depends only on the line and the settings. Sets share the
/// courses of lines that an edit does not change.
class RowCourse {
public:
	/// The part of a row between two points of its line.
	struct Spot {
		glm::dvec2 position;
		glm::dvec2 direction; ///< A unit vector.
	};

	/// Computes the course. Returns the errors of RowSet::set. `line` must not be null.
	Status set(const RowSettings &settings, SharedRowLine line);

	const SharedRowLine &line() const { return line_; }

	/// Returns true if the line has no rows.
	bool empty() const { return points_.empty(); }
	const Rect &bounds() const { return bounds_; }
	const Outline &outline() const { return outline_; }

	/// Returns the number of points in each row along the line.
	std::int64_t count() const { return count_; }

	/// Returns the direction of the rows of an area, a unit vector.
	glm::dvec2 direction() const { return direction_; }

	std::size_t segments() const { return points_.size() - 1; }

	/// Returns the distance along the line from its start to one of its points.
	double length_at(std::size_t point) const { return lengths_[point]; }
	glm::dvec2 point(std::size_t index) const { return points_[index]; }

	/// Returns the segment that contains a distance along the line.
	std::size_t segment_at(double along) const;
	Spot spot_at(std::size_t segment, double along) const;

	/// Returns the ends of a segment, for the search for crossings.
	RowSegment ends_of(std::size_t segment) const;
	Rect box_of(std::size_t segment) const;

	/// Returns true if two segments share a point because one follows the other.
	bool are_consecutive(std::size_t a, std::size_t b) const;

	/// Calls `visit` with each segment that may touch a rectangle. The line must not be the outline of
	/// an area.
	template <class Visit>
	void visit_segments(const Rect &rect, const Visit &visit) const {
		tree_.visit(rect, visit);
	}

private:
	bool is_closed() const { return points_.front() == points_.back(); }
	Status set_count(const RowSettings &settings);
	Status set_direction(const RowSettings &settings);

	SharedRowLine line_;
	std::vector<glm::dvec2> points_; ///< Without repetitions.
	std::vector<double> lengths_;
	std::int64_t count_ = 0;
	Outline outline_;
	Rect bounds_;
	glm::dvec2 direction_{1.0, 0.0};
	RowTree tree_; ///< The segments of a line that is not the outline of an area.
};

using SharedRowCourse = std::shared_ptr<const RowCourse>;

} // namespace thicket
