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

/// A height limit at or beyond this (meters, either sign) is no limit.
inline constexpr double unlimited_height = 1e6;

/// Which points of a set become instances. Each rule is a pure function of one point and the ground under it: a
/// rule takes points away, it never moves one, and it changes nothing for the others. Defaults let all ground pass.
///
/// Every rule gives a density from 0 to 1. They are multiplied, and a point stands if its rank is below the product: what
/// is left of a set is its first points, which are well spaced at every density.
///
/// Limits are hard: nothing stands outside them. A falloff thins inside, towards the limit: the density falls linearly
/// from 1, a falloff away from the limit, to 0 at it. Where the bands of both limits meet, the smaller density counts. A
/// limit that limits nothing (0 and 90 degrees, unlimited_height) has no falloff either.
struct Rules {
	double density = 1.0;           ///< Fraction of the set, 0 to 1.
	double min_slope_degrees = 0.0; ///< Angle between the normal and straight up, 0 to 90 true degrees.
	double max_slope_degrees = 90.0;
	double slope_falloff_degrees = 0.0;    ///< Degrees, 0 to 90; 0 is a sharp limit.
	double min_height = -unlimited_height; ///< World meters, the limit included.
	double max_height = unlimited_height;
	double height_falloff = 0.0; ///< Meters, 0 or more; 0 is a sharp limit.

	/// How deep the ground may lie below the water in meters, the limit included; above it, where the depth is negative, at
	/// or below -unlimited_height everywhere. Where there is no water, the ground lies infinitely far above it.
	double min_water_depth = -unlimited_height;
	double max_water_depth = 0.0;     ///< unlimited_height and more for any depth.
	double water_depth_falloff = 0.0; ///< Meters, 0 or more; 0 is a sharp limit.

	std::shared_ptr<const CurveTable> height_curve{}; ///< Density over the height in world meters; null for none.
	std::shared_ptr<const CurveTable> slope_curve{};  ///< Density over the slope in degrees; null for none.
	std::vector<std::shared_ptr<const DensityField>> fields{}; ///< Densities over the plane, none of them null.
	Clumping clumping{};
	std::vector<std::int32_t> ground_textures{}; ///< Terrain::weigh's weight of these is a density. Empty: any ground.

	/// Meters over which the layer thins towards the edge of what the other rules allow it, 0 to max_edge_feather. Looks at
	/// edge_probes positions around each point, which costs as much ground; see placement/edge_probes.hpp.
	double edge_feather = 0.0;

	// What a designer edits in place. Another one under a pointer here is an edit whose reach can be known.
	std::shared_ptr<const PaintedMask> mask{}; ///< Null for none.
	std::shared_ptr<const ShapeSet> shapes{};  ///< Null for none.
	std::shared_ptr<const BiomeDensity>
			biome{}; ///< The weight of the layer's biomes; null for a layer that stands in all.
	std::shared_ptr<const WaterLevels> water{}; ///< Null for no water anywhere.

	friend bool operator==(const Rules &, const Rules &) = default;
};

inline constexpr double max_edge_feather = 1e3;

/// Refuses what is not finite, outside the ranges above, a minimum above its maximum, or a field that is null.
Status validate(const Rules &rules);

/// Whether there is ground on which something may stand: with a height and a normal that are finite, and a normal that points up.
inline bool is_ground(const Ground &ground) {
	return std::isfinite(ground.height) && std::isfinite(ground.normal.x) && std::isfinite(ground.normal.y) &&
			std::isfinite(ground.normal.z) && ground.normal.y > 0.0f;
}

/// Rules made ready for many points. Immutable after `set`, so threads may share one.
class PreparedRules {
public:
	/// Prepares `rules` for the set of that seed, or refuses them as `validate` does and stays as it was.
	Status set(const Rules &rules, std::uint64_t seed);

	const Rules &rules() const { return rules_; }

	/// Whether the slope of the ground counts.
	bool look_at_slope() const { return !slope_.open() || rules_.slope_curve != nullptr; }

	/// Replaces `r_densities` by the product of the rules that depend on the position alone, so that they can be asked before
	/// the ground is known: density, fields, mask, biome, clumping. `scratch` is working memory that is kept for the next time.
	/// Fails as a field does.
	Status place_densities(
			std::span<const glm::dvec2> positions, std::span<double> r_densities, std::vector<float> &scratch) const;

	/// The same for one position, with all factors. Throws std::bad_alloc.
	Status place_factors(glm::dvec2 position, const RuleRecord &record) const;

	/// True if no point of `rect` can stand, whatever else the rules say: none of the layer's biomes is there.
	bool closed_in(const Rect &rect) const { return rules_.biome != nullptr && rules_.biome->none_in(rect); }

	/// The product of the rules that look at the ground at a position: limits, curves, textures, depth of the water. No ground (a
	/// height or a normal that is not finite, a normal that does not point up) has a density of 0.
	/// `record` is told of all factors but those of rules that limit nothing; without ground there is no other.
	template <class Record = NoRecord>
	double ground_density(const Ground &ground, glm::dvec2 position, const Record &record = {}) const {
		if (!Record::complete && slope_alone_) {
			// Fast path: no other rule asks for the ground.
			return is_ground(ground) ? slope_.density_of(ground.normal) : 0.0;
		}
		return density_of_limits(ground, position, record);
	}

	/// Whether that density is above 0.
	bool allow(const Ground &ground, glm::dvec2 position) const { return ground_density(ground, position) > 0.0; }

	/// The factor of the shapes, given those near (ShapeSet::near); 1 for a layer without shapes.
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
	bool slope_alone_ = false; ///< Whether no other rule looks at the ground.
	ClumpNoise clumps_;
};

/// A point stands if its rank, as a fraction of 2^32, is below the product of all densities. 1 keeps all, 0 none.
constexpr bool stands(std::uint32_t rank, double density) { return rank < density * 0x1p32; }

/// The rank of a point that stands in the order in which a layer thins: its rank over its density, so that below a
/// fraction q lie just those that would stand if every density were q times as large.
constexpr std::uint32_t thinning_rank(std::uint32_t rank, double density) {
	const double fraction = rank / density;
	return fraction < 0x1p32 ? static_cast<std::uint32_t>(fraction) : 0xffffffffu;
}

} // namespace thicket
