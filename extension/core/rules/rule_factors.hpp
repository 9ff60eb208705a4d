#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// A rule that contributes a factor to a layer's density at a position. The kinds are listed in
/// order of evaluation.
enum class RuleKind : std::uint8_t {
	// The following rules depend only on the position.
	density,
	field, ///< A density field, such as noise or an image.
	mask,
	biome, ///< BiomeDensity: the layer's density in the biomes at the position.
	clumping,
	// The following rules depend on the ground at the position.
	ground, ///< The factor is 1 if there is any ground, otherwise 0.
	height,
	height_curve,
	ground_textures,
	water_depth,
	slope,
	slope_curve,
	expression, ///< DensityExpression.
	density_rule,
	// The following rules depend on other objects nearby.
	shapes,
	neighbor, ///< Spacing or proximity to a neighbor.
	edge_feather,
};

/// The value of RuleFactor::index if the rule has no index.
inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

/// The result of one rule at one position.
struct RuleFactor {
	RuleKind rule = RuleKind::density;

	/// The input of the rule: a height, depth or distance in meters, a slope in degrees, or the
	/// rule's density itself. For an edge feather, the fraction of the surroundings where the layer
	/// can grow. NAN if there is no input, for example without ground.
	double value = std::numeric_limits<double>::quiet_NaN();

	double density = 1.0; ///< The factor, 0 to 1.

	/// Index of the field, density rule or neighbor. For shapes, the index of the decisive shape, or no_index
	/// outside all including shapes.
	std::uint32_t index = no_index;
};

/// A recorder receives each factor during the evaluation of rules, and the evaluation uses the
/// recorder's return value. Tile generation uses NoRecord, which stores nothing, so that the
/// compiler removes it.
struct NoRecord {
	/// True if all factors must be evaluated, even after one of them was 0.
	static constexpr bool complete = false;

	double operator()(RuleKind, double /*value*/, double density, std::uint32_t /*index*/ = no_index) const {
		return density;
	}
};

/// A recorder that stores all factors of one position. Throws std::bad_alloc.
class RuleRecord {
public:
	static constexpr bool complete = true;

	/// Creates a recorder that appends to `r_factors`, which must outlive this object.
	/// `density_rules` contains the density of each of Rules::density_rules at the position; it is
	/// empty if there are none, or if there is no ground.
	explicit RuleRecord(std::vector<RuleFactor> &r_factors, std::span<const float> density_rules = {}) :
			factors_(&r_factors), density_rules_(density_rules) {}

	std::span<const float> density_rules() const { return density_rules_; }

	double operator()(RuleKind rule, double value, double density, std::uint32_t index = no_index) const {
		factors_->push_back({rule, value, density, index});
		return density;
	}

private:
	std::vector<RuleFactor> *factors_;
	std::span<const float> density_rules_;
};

/// Returns the product of all factors of a position. The factors are multiplied in the same order
/// as in tile generation, so the result is bit-identical to the density in the tile.
double product_of(std::span<const RuleFactor> factors);

/// Returns the factor that reduces the density most: the first of the smallest factors. Returns
/// null if no factor is below 1.
const RuleFactor *strictest(std::span<const RuleFactor> factors);

} // namespace thicket
