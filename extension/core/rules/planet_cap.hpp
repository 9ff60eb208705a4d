#pragma once

#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/base/tile_grid.hpp"

#include <glm/vec3.hpp>

namespace thicket {

/// All directions from a planet's center within an angle of a middle direction. Used to bound the part
/// of a planet that a tile covers or that an edit affects.
struct PlanetCap {
	glm::dvec3 middle{0.0, 1.0, 0.0}; ///< Unit vector.
	/// Sine of the largest angle from the middle. At 1 or more, the cap is the whole planet.
	double sine = 1.0;

	bool is_whole() const { return !(sine < 1.0); }
};

/// Degrees by which a computed angle may differ from its exact value, or more.
inline constexpr double angle_rounding = 1e-6;

/// Returns a cap that contains all directions within a straight distance of a direction. `distance` is
/// in units of the planet's radius.
PlanetCap cap_within(const glm::dvec3 &middle, double distance);

/// Returns a cap that contains all directions from the planet's center to positions in `space`.
PlanetCap cap_around(const Planet &planet, const TileSpace &space);

/// Returns a rectangle that contains the world x and z of all positions at which there may be
/// instances (see Planet::top) and whose direction is in `cap`. It may be infinite.
Rect shadow_of(const Planet &planet, const PlanetCap &cap);

} // namespace thicket
