#pragma once

#include "core/base/planet.hpp"
#include "core/rules/density_rule.hpp"
#include "core/rules/ground_sides.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// The density rules of a layer, and how they see the ground.
struct DensityRuleQuery {
	std::span<const SharedDensityRule> rules{};
	GroundSides sides = GroundSides::top;
	Planet planet{}; ///< Slopes are relative to the direction away from its center, if it exists.

	/// Sets Ground::density at all `positions` (world meters) to the product of the rules. The other
	/// values of `r_ground` must be known, including the normals. Positions without ground (see
	/// is_ground) stay unchanged. Returns the first error of a rule. Throws std::bad_alloc.
	Status query(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;

	/// Replaces `r_densities` with the density of each rule at one position, or with an empty list if
	/// there is no ground. Their product in floats is bit-identical to Ground::density. Throws
	/// std::bad_alloc.
	Status find_each(glm::dvec2 position, const Ground &ground, std::vector<float> &r_densities) const;
};

} // namespace thicket
