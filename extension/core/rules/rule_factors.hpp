#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// A rule of a layer, as far as it gives a factor of the density at a place. In the order in which they are asked.
enum class RuleKind : std::uint8_t {
	// Of the position alone.
	density,
	field, ///< Noise or an image.
	mask,
	biome, ///< The weight of the layer's biomes.
	clumping,
	// Of the ground there.
	ground, ///< That there is any.
	height,
	height_curve,
	ground_textures,
	water_depth,
	slope,
	slope_curve,
	// Of what else is there.
	shapes,
	neighbor, ///< Spacing or proximity.
	edge_feather,
};

/// For RuleFactor::index where there is nothing to point at.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// What one rule makes of one place.
struct RuleFactor {
	RuleKind rule = RuleKind::density;

	/// What the rule looked at: meters of height, depth or distance, degrees of slope, or a density of its own; of an edge feather, the share
	/// of the surroundings that is open to the layer. NAN for nothing, as where there is no ground.
	double value = std::numeric_limits<double>::quiet_NaN();

	double density = 1.0; ///< The factor, 0 to 1.

	/// Which of the fields or neighbors; of the shapes, the one that decides: no_index outside all that include.
	std::uint32_t index = no_index;
};

/// What evaluates rules tells a recorder of each factor on the way, and takes the factor back from it. This one keeps nothing, and the
/// compiler leaves it out: tiles are made with it.
struct NoRecord {
	/// Whether every factor is wanted, also of places of which it is known already that nothing stands there.
	static constexpr bool complete = false;

	double operator()(RuleKind, double /*value*/, double density, std::uint32_t /*index*/ = no_index) const {
		return density;
	}
};

/// Keeps all factors of one place. Throws std::bad_alloc.
class RuleRecord {
public:
	static constexpr bool complete = true;

	/// Adds to `r_factors`, which has to live as long.
	explicit RuleRecord(std::vector<RuleFactor> &r_factors) : factors_(&r_factors) {}

	double operator()(RuleKind rule, double value, double density, std::uint32_t index = no_index) const {
		factors_->push_back({rule, value, density, index});
		return density;
	}

private:
	std::vector<RuleFactor> *factors_;
};

/// The density that all factors of a place give together, multiplied in the order in which tiles are made: the same to the bit.
double product_of(std::span<const RuleFactor> factors);

/// The factor that takes most: the first of the smallest, if it is below 1; null for none.
const RuleFactor *strictest(std::span<const RuleFactor> factors);

} // namespace thicket
