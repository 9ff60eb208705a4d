#pragma once

#include "core/base/rect.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A grid of buckets for finding the nearest point. Reuses its memory for the next set of points.
class PointGrid {
public:
	/// Takes points that lie in `area`. `cell_size` (meters, above 0) is about the distance of later queries. Where points are denser,
	/// cells are smaller, so that the cost of a long distance does not grow with its square.
	void set(std::span<const glm::dvec2> points, const Rect &area, double cell_size);

	/// The squared distance to the nearest point that is closer than `distance` meters; the square of `distance` if there is none. The
	/// result does not depend on the order of the points or on the area, bit for bit.
	double nearest_squared(glm::dvec2 position, double distance) const;

private:
	glm::ivec2 cell_of(glm::dvec2 position) const;
	double nearest_in_row(glm::dvec2 position, int y, int first, int last, double nearest) const;
	double nearest_outwards(glm::dvec2 position, glm::ivec2 first, glm::ivec2 last, double nearest) const;

	Rect area_;
	double cells_per_meter_ = 1.0;
	glm::ivec2 cells_{0};
	std::vector<std::uint32_t> begin_; ///< One more than there are cells; indices into points_.
	std::vector<glm::dvec2> points_;   ///< Sorted by cell.
};

} // namespace thicket
