#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A grid on the plane for nearest-neighbor queries. It reuses its memory for the next set of
/// points. `Point` is glm::dvec2 for distances in the plane, or glm::dvec3, with y up, for
/// distances in space.
template <class Point>
class PointGrid {
public:
	/// Sets the points, all of which must be in `area`. `cell_size` (meters, above 0) should be
	/// about the distance of later queries. If points are dense, cells are smaller, so that the
	/// cost of a query does not grow with the square of its distance.
	void set(std::span<const Point> points, const Rect &area, double cell_size);

	/// Returns the squared distance to the nearest point, or the square of `distance` (meters) if
	/// no point is closer than that. The result is bit-identical for any order of the points and
	/// any area.
	double nearest_squared(const Point &position, double distance) const;

private:
	glm::ivec2 cell_of(glm::dvec2 position) const;
	double nearest_in_row(const Point &position, int y, int first, int last, double nearest) const;
	double nearest_outwards(const Point &position, glm::ivec2 first, glm::ivec2 last, double nearest) const;

	Rect area_;
	double cells_per_meter_ = 1.0;
	glm::ivec2 cells_{0};
	std::vector<std::uint32_t> begin_;
	std::vector<Point> points_; ///< The points, sorted by cell.
};

extern template class PointGrid<glm::dvec2>;
extern template class PointGrid<glm::dvec3>;

} // namespace thicket
