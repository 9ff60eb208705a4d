#pragma once

#include "core/base/status.hpp"
#include "core/rules/biome_rules.hpp"
#include "core/rules/clump_noise.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/density_field.hpp"
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

/// A height limit at or beyond this value (meters, either sign) has no effect.
inline constexpr double unlimited_height = 1e6;

/// The rules that decide which points of a set become instances. Each rule is a pure function of one point and the ground under it. A
/// rule removes points, never moves one, and has no effect on other points. By default, all ground passes.
///
/// Every rule returns a density from 0 to 1. The densities are multiplied, and a point becomes an instance if its rank is below the
/// product. The remaining instances are therefore the first points of the set, which are well spaced at every density.
///
/// Limits are hard: no instance is placed outside them. A falloff thins the layer inside a limit: the density falls linearly from 1, one
/// falloff away from the limit, to 0 at the limit. Where the falloffs of both limits overlap, the smaller density counts. A limit without
/// effect (0 and 90 degrees, unlimited_height) has no falloff either.
struct Rules {
	double density = 1.0;           ///< Fraction of the set, 0 to 1.
	double min_slope_degrees = 0.0; ///< Angle between the normal and straight up, 0 to 90 degrees.
	double max_slope_degrees = 90.0;
	double slope_falloff_degrees = 0.0;    ///< Degrees, 0 to 90. 0 is a sharp limit.
	double min_height = -unlimited_height; ///< World meters. The limit itself passes.
	double max_height = unlimited_height;
	double height_falloff = 0.0; ///< Meters, 0 or more. 0 is a sharp limit.

	/// Depth of the ground below the water in meters; limits included. The depth is negative above the water. A minimum at or below
	/// -unlimited_height has no effect. Where there is no water, the ground counts as infinitely far above it.
	double min_water_depth = -unlimited_height;
	double max_water_depth = 0.0;     ///< unlimited_height or more for any depth.
	double water_depth_falloff = 0.0; ///< Meters, 0 or more. 0 is a sharp limit.

	std::shared_ptr<const CurveTable> height_curve{}; ///< Density over height in world meters. Null if there is none.
	std::shared_ptr<const CurveTable> slope_curve{};  ///< Density over slope in degrees. Null if there is none.
	std::vector<std::shared_ptr<const DensityField>> fields{}; ///< Densities over the plane. None is null.
	Clumping clumping{};
	std::vector<std::int32_t> ground_textures{}; ///< Their weight (Terrain::weigh) is a density. Empty: any ground.

	/// Meters over which the layer thins towards the edge of the area that the other rules permit, 0 to max_edge_feather. Samples
	/// edge_probes positions around each point, which costs as many ground queries; see placement/edge_probes.hpp.
	double edge_feather = 0.0;

	// Objects that a designer edits in place. If one of these pointers changes, the reach of the edit can be computed.
	std::shared_ptr<const PaintedMask> mask{}; ///< Null if there is none.
	std::shared_ptr<const ShapeSet> shapes{};  ///< Null if there are none.
	std::shared_ptr<const BiomeDensity>
			biome{}; ///< Weight of the layer's biomes. Null for a layer that grows in all biomes.
	std::shared_ptr<const WaterLevels> water{}; ///< Null if there is no water anywhere.

	friend bool operator==(const Rules &, const Rules &) = default;
};

inline constexpr double max_edge_feather = 1e3;

/// Refuses values that are not finite or outside the ranges above, a minimum above its maximum, and a null field.
Status validate(const Rules &rules);

/// Whether instances can be placed on the ground: its height and normal are finite, and its normal points up.
inline bool is_ground(const Ground &ground) {
	return std::isfinite(ground.height) && std::isfinite(ground.normal.x) && std::isfinite(ground.normal.y) &&
			std::isfinite(ground.normal.z) && ground.normal.y > 0.0f;
}

/// Rules prepared for many points. Immutable after `set`, so threads may share one.
class PreparedRules {
public:
	/// Prepares `rules` for the set with this seed. If `validate` refuses them, this object is unchanged.
	Status set(const Rules &rules, std::uint64_t seed);

	const Rules &rules() const { return rules_; }

	/// Whether any rule depends on the slope of the ground.
	bool look_at_slope() const { return !slope_.open() || rules_.slope_curve != nullptr; }

	/// Replaces `r_densities` by the product of the rules that depend only on the position: density, fields, mask,
	/// biome, clumping. These rules can be evaluated before the ground is known. `scratch` is working memory that is
	/// reused by later calls. Fails if a field fails.
	Status place_densities(
			std::span<const glm::dvec2> positions, std::span<double> r_densities, std::vector<float> &scratch) const;

	/// Evaluates the rules that depend only on the position, at one position, and records all factors. Throws std::bad_alloc.
	Status place_factors(glm::dvec2 position, const RuleRecord &record) const;

	/// True if no instance can be placed in `rect`, whatever the other rules, because none of the layer's biomes occurs there.
	bool closed_in(const Rect &rect) const { return rules_.biome != nullptr && rules_.biome->none_in(rect); }

	/// The product of the rules that depend on the ground at a position: limits, curves, textures, water depth. Returns 0 without ground,
	/// which means a height or normal that is not finite, or a normal that does not point up. `record` receives all factors, except those
	/// of rules without effect. Without ground it receives no factor but that of the ground.
	template <class Record = NoRecord>
	double ground_density(const Ground &ground, glm::dvec2 position, const Record &record = {}) const {
		if (!Record::complete && slope_alone_) {
			// No rule but the slope depends on the ground.
			return is_ground(ground) ? slope_.density_of(ground.normal) : 0.0;
		}
		return density_of_limits(ground, position, record);
	}

	/// Whether that density is above 0.
	bool allow(const Ground &ground, glm::dvec2 position) const { return ground_density(ground, position) > 0.0; }

	/// The factor of the shapes, given the ones nearby (ShapeSet::near). Returns 1 for a layer without shapes.
	template <class Record = NoRecord>
	double shape_density(std::span<const std::uint32_t> near, glm::dvec2 position, const Ground &ground,
			const Record &record = {}) const;

private:
	template <class Record>
	double density_of_limits(const Ground &ground, glm::dvec2 position, const Record &record) const;

	template <class Record>
	Status place_product(std::span<const glm::dvec2> positions, std::span<double> r_densities,
			std::vector<float> &scratch, const Record &record) const;

	template <class Record>
	double water_density(double height, glm::dvec2 position, const Record &record) const;

	Rules rules_;
	SlopeRange slope_;
	PreparedRange height_;
	PreparedRange water_depth_;
	bool slope_alone_ = false; ///< Whether the slope is the only rule that depends on the ground.
	ClumpNoise clumps_;
};

/// A point becomes an instance if its rank, as a fraction of 2^32, is below the product of all densities. 1 keeps all points, 0 none.
constexpr bool stands(std::uint32_t rank, double density) { return rank < density * 0x1p32; }

/// The rank of an instance in the order in which its layer thins: its rank divided by its density. The instances below a fraction q are
/// those that would be placed if every density were multiplied by q.
constexpr std::uint32_t thinning_rank(std::uint32_t rank, double density) {
	const double fraction = rank / density;
	return fraction < 0x1p32 ? static_cast<std::uint32_t>(fraction) : 0xffffffffu;
}

} // namespace thicket
