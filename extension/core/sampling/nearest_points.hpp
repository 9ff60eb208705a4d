#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/vec2.hpp>

#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// Returns the smallest rectangle that contains all positions; positions may lie on its far edges.
/// If a position is not finite, the rectangle is not finite either. There must be at least one
/// position.
Rect enclosing_rect(std::span<const glm::dvec2> positions);

/// Means "no point" in the results of nearest_among. Its rank is the highest possible one.
inline constexpr SamplePoint no_point{
		.position = glm::dvec2(std::numeric_limits<double>::infinity()), .id = 0, .rank = ~0u, .level = 0};

/// Returns an area that contains the nearest points of all positions in `area`.
Rect point_area(const PointSet &set, const Rect &area);

/// Finds the point among `points` that is nearest to each position, or no_point if none is nearer
/// than the radius of `set`. All points must lie in the point_area of the positions. If two points are
/// equally near, the one with the smaller id is found. Replaces the contents of `r_points`. Throws
/// std::bad_alloc.
void nearest_among(const std::vector<SamplePoint> &points, const PointSet &set, std::span<const glm::dvec2> positions,
		std::vector<SamplePoint> &r_points);

/// Finds the point of `set` that is nearest to each position (world meters). It is always closer
/// than the radius, because otherwise another point would fit. If two points are equally near, the
/// one with the smaller id is found. Replaces the contents of `r_points`, which is empty after an
/// error. The positions should lie close together, because the call samples the whole rectangle
/// around them. Errors are those of TileSampler::sample(), and ErrorCode::not_finite if a position
/// is not finite.
Status nearest_points(TileSampler &sampler, const PointSet &set, std::span<const glm::dvec2> positions,
		std::vector<SamplePoint> &r_points);

} // namespace thicket
