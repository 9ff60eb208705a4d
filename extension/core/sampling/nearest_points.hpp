#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// The smallest rectangle that contains all positions, including its far edges. Not finite if a position is not. Requires at least one
/// position.
Rect enclosing_rect(std::span<const glm::dvec2> places);

/// Finds the nearest point of a set for each of some positions (world meters). Each is closer than the radius, because otherwise a
/// further point would fit. Of two points at the same distance, the one with the smaller id is chosen. Replaces `r_points`, which is
/// empty after an error. The positions should lie close together, because all points around them are sampled. Fails like
/// TileSampler::sample, and refuses positions that are not finite.
Status nearest_points(TileSampler &sampler, const PointSet &set, std::span<const glm::dvec2> places,
		std::vector<SamplePoint> &r_points);

} // namespace thicket
