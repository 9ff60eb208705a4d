#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// The smallest rectangle that holds all places, its far edges included; one that is not finite if a place is not. At least one place.
Rect enclosing_rect(std::span<const glm::dvec2> places);

/// The points of a set that are nearest to some places (world meters), one for each: closer than the radius, or there would be room for
/// one more. Of two at the same distance that with the smaller id. Replaces `r_points`; after an error they are none. The places should
/// lie close together: all points around them are sampled. Fails as TileSampler::sample does, and refuses places that are not finite.
Status nearest_points(TileSampler &sampler, const PointSet &set, std::span<const glm::dvec2> places,
		std::vector<SamplePoint> &r_points);

} // namespace thicket
