#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// A rule of a layer that contributes a factor to the density at a position. In order of evaluation.
enum class RuleKind : std::uint8_t {
	// Depend only on the position.
	density,
	field, ///< Noise or an image.
	mask,
	biome, ///< Weight of the layer's biomes.
	clumping,
	// Depend on the ground there.
	ground, ///< Whether there is any ground.
	height,
	height_curve,
	ground_textures,
	water_depth,
	slope,
	slope_curve,
	// Depend on other objects there.
	shapes,
	neighbor, ///< Spacing or proximity.
	edge_feather,
};

/// Value of RuleFactor::index where no index applies.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// The result of one rule at one position.
struct RuleFactor {
	RuleKind rule = RuleKind::density;

	/// The input of the rule: meters of height, depth or distance, degrees of slope, or a density of its own. For an edge feather, the
	/// share of the surroundings that is open to the layer. NAN if there is none, as where there is no ground.
	double value = std::numeric_limits<double>::quiet_NaN();

	double density = 1.0; ///< The factor, 0 to 1.

	/// Index of the field or neighbor. For shapes, the index of the decisive shape, or no_index outside all including
	/// shapes.
	std::uint32_t index = no_index;
};

/// The evaluation of rules passes each factor to a recorder and uses the recorder's return value. This recorder stores
/// nothing, so the compiler removes it. Tiles are generated with this recorder.
struct NoRecord {
	/// Whether every factor is needed, even where it is already known that no instance can be placed.
	static constexpr bool complete = false;

	double operator()(RuleKind, double /*value*/, double density, std::uint32_t /*index*/ = no_index) const {
		return density;
	}
};

/// Keeps all factors of one position. Throws std::bad_alloc.
class RuleRecord {
public:
	static constexpr bool complete = true;

	/// Appends to `r_factors`, which must outlive this object.
	explicit RuleRecord(std::vector<RuleFactor> &r_factors) : factors_(&r_factors) {}

	double operator()(RuleKind rule, double value, double density, std::uint32_t index = no_index) const {
		factors_->push_back({rule, value, density, index});
		return density;
	}

private:
	std::vector<RuleFactor> *factors_;
};

/// The product of all factors of a position, multiplied in the order used for tiles, so that it is bit-identical to the
/// tiles' density.
double product_of(std::span<const RuleFactor> factors);

/// The factor that reduces the density most: the smallest one if it is below 1; the first of equal ones. Null if there
/// is none.
const RuleFactor *strictest(std::span<const RuleFactor> factors);

} // namespace thicket
