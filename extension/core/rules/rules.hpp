#pragma once

#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/rules/biome_rules.hpp"
#include "core/rules/clump_noise.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/density_expression.hpp"
#include "core/rules/density_field.hpp"
#include "core/rules/density_rule.hpp"
#include "core/rules/ground_sides.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/prepared_range.hpp"
#include "core/rules/rule_factors.hpp"
#include "core/rules/shapes.hpp"
#include "core/terrain/terrain.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Height limits at or beyond this value in meters, of either sign, have no effect.
inline constexpr double unlimited_height = 1e6;

/// The rules that determine the points of a set that become instances. Each rule is a pure function
/// of one point and the ground under it. A rule can only remove its point: it neither moves the
/// point nor affects other points. By default, every point on the ground is kept.
///
/// Every rule returns a density from 0 to 1. The densities are multiplied, and a point becomes an
/// instance if its rank is below the product. The points with the lowest ranks are kept. With
/// several levels, these keep at least half of the distance of a complete set of equal density.
///
/// Limits are hard: no instance is placed outside them. A falloff thins the layer inside a limit:
/// the density falls linearly from 1, one falloff away from the limit, to 0 at the limit. Where the
/// falloffs of both limits overlap, the smaller density is used. A limit without effect (0 and 90
/// degrees, 180 on surfaces, unlimited_height) has no falloff either.
struct Rules {
	double density = 1.0; ///< Fraction of the points to keep, 0 to 1.
	/// Angle in degrees between the normal and straight up: 0 for a floor, 90 for a wall, 180 for a
	/// ceiling. Only surfaces have angles above 90.
	double min_slope_degrees = 0.0;
	double max_slope_degrees = 90.0;
	double slope_falloff_degrees = 0.0;    ///< Degrees, 0 to 90. 0 is a sharp limit.
	double min_height = -unlimited_height; ///< Minimum height in world meters, inclusive.
	double max_height = unlimited_height;
	double height_falloff = 0.0; ///< Meters, 0 or more. 0 is a sharp limit.

	/// Depth of the ground below the water surface in meters, inclusive; negative above the
	/// surface. A minimum at or below -unlimited_height has no effect. Without water, the depth is
	/// minus infinity.
	double min_water_depth = -unlimited_height;
	double max_water_depth = 0.0;     ///< unlimited_height or more disables this limit.
	double water_depth_falloff = 0.0; ///< Meters, 0 or more. 0 is a sharp limit.

	std::shared_ptr<const CurveTable> height_curve{}; ///< Density over height in world meters. Null if there is none.
	std::shared_ptr<const CurveTable> slope_curve{};  ///< Density over slope in degrees. Null if there is none.
	/// A density computed from the ground and the position. The value is clamped to 0 to 1, and NAN
	/// is 0. Null if there is none.
	std::shared_ptr<const DensityExpression> expression{};
	std::vector<std::shared_ptr<const DensityField>> fields{}; ///< Densities over the plane. No entry is null.
	Clumping clumping{};
	/// The ground textures on which the layer grows (see Terrain::weigh). Their total weight at a
	/// position is a density. If the list is empty, the layer grows on any ground.
	std::vector<std::int32_t> ground_textures{};
	/// Rules whose product is queried together with the ground (Ground::density), because some may
	/// only be called on the main thread. At most max_density_rules. No entry is null.
	std::vector<SharedDensityRule> density_rules{};

	/// Distance in meters over which the layer thins toward the edge of the area that the other
	/// rules permit, 0 to max_edge_feather. It costs edge_probes additional ground queries per
	/// point; see placement/edge_probes.hpp.
	double edge_feather = 0.0;

	// Objects that the user edits interactively. If one of these pointers changes, the affected
	// area can be computed.
	std::shared_ptr<const PaintedMask> mask{}; ///< Null if there is none.
	std::shared_ptr<const ShapeSet> shapes{};  ///< Null if there are none.
	/// The layer's density per biome. Null for a layer that grows in all biomes.
	std::shared_ptr<const BiomeDensity> biome{};
	std::shared_ptr<const WaterLevels> water{}; ///< Null if there is no water anywhere.

	friend bool operator==(const Rules &, const Rules &) = default;
};

/// Returns rules that permit everything, also in water and on undersides of surfaces.
inline Rules open_rules() {
	Rules rules;
	rules.max_slope_degrees = 180.0;
	rules.max_water_depth = unlimited_height;
	return rules;
}

inline constexpr double max_edge_feather = 1e3;

/// Returns an error for values that are not finite or outside the ranges above, for a minimum above
/// its maximum, and for null fields or density rules.
Status validate(const Rules &rules);

/// Returns true if any of the rules depends on the slope of the ground. Density rules always receive
/// it.
bool needs_slope(const Rules &rules, GroundSides sides);

/// Rules prepared for evaluation at many points. Immutable after `set`, so threads may share one
/// object.
class PreparedRules {
public:
	/// Prepares `rules` for the set with this seed. On a planet, heights become altitudes, slopes are
	/// relative to the direction away from its center, and the mask and the biomes cover the sphere.
	/// If `validate` returns an error, this object is unchanged.
	Status set(const Rules &rules, std::uint64_t seed, GroundSides sides = GroundSides::top, const Planet &planet = {});

	const Rules &rules() const { return rules_; }

	/// Returns true if any rule depends on the slope of the ground.
	bool needs_slope() const { return needs_slope_; }

	/// Writes to `r_densities` the product of the rules that depend only on the position: density,
	/// fields, mask, biome, clumping. These rules can be evaluated before the ground is queried.
	/// `scratch` is working memory; pass the same vector to later calls. If a field fails, the
	/// function returns its error.
	Status position_densities(
			const PositionBatch &batch, std::span<double> r_densities, std::vector<float> &scratch) const;

	/// Evaluates the rules of position_densities at the single position in `batch` and records all
	/// factors. Throws std::bad_alloc.
	Status position_factors(const PositionBatch &batch, const RuleRecord &record) const;

	/// Returns true if no instance can be placed in `space` because none of the layer's biomes
	/// occurs there.
	bool closed_in(const TileSpace &space) const {
		return rules_.biome != nullptr &&
				(planet_.exists() ? rules_.biome->none_on(planet_, space) : rules_.biome->none_in(space));
	}

	/// Sets `r_closed` to true if no instance can be placed in `space`: see closed_in, or because a
	/// density rule is 0 there. Calls only thread-safe density rules.
	Status find_closed(const TileSpace &space, bool &r_closed) const;

	/// Returns the product of the rules that depend on the ground at a world position: limits, curves,
	/// textures, water depth, the expression, density rules. The product is 0 without ground (see
	/// is_ground). `record` receives the factors of all rules that have an effect, or only the factor
	/// of the ground if there is none. `world` contains the values of the expression's world inputs.
	template <class Record = NoRecord>
	double ground_density(const Ground &ground, glm::dvec2 position, const Record &record = {},
			std::span<const float> world = {}) const {
		if (planet_.exists()) {
			return density_on_planet(ground, position, record, world);
		}
		if (!Record::complete && slope_alone_) {
			// Only the slope rule depends on the ground.
			return is_ground(ground, sides_) ? slope_.density_of(ground.normal) : 0.0;
		}
		return density_of_limits(ground, {position.x, ground.height, position.y}, record, world);
	}

	/// Returns true if ground_density is above 0.
	bool allow(const Ground &ground, glm::dvec2 position, std::span<const float> world = {}) const {
		return ground_density(ground, position, NoRecord(), world) > 0.0;
	}

	/// Returns the factor of the shapes. `nearby_shapes` lists the shapes nearby (ShapeSet::near).
	/// The factor is 1 for a layer without shapes.
	template <class Record = NoRecord>
	double shape_density(std::span<const std::uint32_t> nearby_shapes, glm::dvec2 position, const Ground &ground,
			const Record &record = {}) const;

private:
	template <class Record>
	double density_on_planet(
			const Ground &ground, glm::dvec2 position, const Record &record, std::span<const float> world) const;

	template <class Record>
	double density_of_limits(
			const Ground &ground, const glm::dvec3 &position, const Record &record, std::span<const float> world) const;

	double water_level_at(const glm::dvec3 &position) const;

	template <class Record>
	Status position_product(const PositionBatch &batch, std::span<double> r_densities, std::vector<float> &scratch,
			const Record &record) const;

	bool expression_uses(ExpressionInput input) const {
		return rules_.expression != nullptr && rules_.expression->uses(input);
	}

	template <class Record>
	double expression_density(
			const Ground &ground, const glm::dvec3 &position, const Record &record, std::span<const float> world) const;

	template <class Record>
	double water_density(double height, const glm::dvec3 &position, const Record &record) const;

	Rules rules_;
	GroundSides sides_ = GroundSides::top;
	Planet planet_;
	SlopeRange slope_;
	PreparedRange height_;
	PreparedRange water_depth_;
	bool needs_slope_ = false;
	bool slope_alone_ = false; ///< True if the slope is the only rule that depends on the ground.
	ClumpNoise clumps_;
	std::uint64_t expression_seed_ = 0;
};

/// Returns true if a point becomes an instance: its rank, as a fraction of 2^32, must be below the
/// product of all densities. A product of 1 keeps all points, and 0 keeps none.
constexpr bool is_placed(std::uint32_t rank, double density) { return rank < density * 0x1p32; }

/// Returns the instance's position in the order in which its layer is thinned: its rank divided by
/// its density. The instances below q * 2^32 are those that would be placed if every density were
/// multiplied by q.
constexpr std::uint32_t thinning_rank(std::uint32_t rank, double density) {
	const double fraction = rank / density;
	return fraction < 0x1p32 ? static_cast<std::uint32_t>(fraction) : 0xffffffffu;
}

} // namespace thicket
