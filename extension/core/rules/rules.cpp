#include "core/rules/rules.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"
#include "core/base/trigonometry.hpp"
#include "core/terrain/planet_ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

constexpr double max_slope = SlopeRange::steepest_surface;

Status check_height(const char *property, double height) {
	// Infinity is an error: a setting that has no limit uses unlimited_height.
	return check_range(property, height, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

SlopeRange slope_range(const Rules &rules, GroundSides sides) {
	return {rules.min_slope_degrees, rules.max_slope_degrees, rules.slope_falloff_degrees,
			sides == GroundSides::top ? SlopeRange::steepest_top : SlopeRange::steepest_surface};
}

/// Multiplies densities by those that `sample` computes.
template <class Record, class Sample>
Status multiply(const Sample &sample, std::span<double> r_densities, std::span<float> scratch, const Record &record,
		RuleKind rule, std::size_t index) {
	const Status status = sample(scratch);
	for (std::size_t i = 0; status.ok() && i < scratch.size(); ++i) {
		const double density = unit_density(scratch[i]);
		r_densities[i] *= record(rule, density, density, static_cast<std::uint32_t>(index));
	}
	return status;
}

} // namespace

Status validate(const Rules &rules) {
	const auto null_at = [](const char *property, const auto &list) {
		return std::ranges::find(list, nullptr) != list.end() ? Status{ErrorCode::missing, property, 0.0} : Status{};
	};
	const std::size_t density_rules = rules.density_rules.size();
	return first_failure(check_range("density", rules.density, 0.0, 1.0),
			check_range("min_slope_degrees", rules.min_slope_degrees, 0.0, max_slope),
			check_range("max_slope_degrees", rules.max_slope_degrees, 0.0, max_slope),
			check_order("max_slope_degrees", rules.min_slope_degrees, rules.max_slope_degrees),
			check_range("slope_falloff_degrees", rules.slope_falloff_degrees, 0.0, max_slope),
			check_height("min_height", rules.min_height), check_height("max_height", rules.max_height),
			check_order("max_height", rules.min_height, rules.max_height),
			check_range("height_falloff", rules.height_falloff, 0.0, std::numeric_limits<double>::max()),
			check_height("min_water_depth", rules.min_water_depth),
			check_height("max_water_depth", rules.max_water_depth),
			check_order("max_water_depth", rules.min_water_depth, rules.max_water_depth),
			check_range("water_depth_falloff", rules.water_depth_falloff, 0.0, std::numeric_limits<double>::max()),
			validate(rules.clumping), check_range("edge_feather", rules.edge_feather, 0.0, max_edge_feather),
			null_at("fields", rules.fields), null_at("density_rules", rules.density_rules),
			density_rules > max_density_rules
					? Status::wrong_size("density_rules", density_rules, at_most(max_density_rules, "entries"))
					: Status{});
}

bool needs_slope(const Rules &rules, GroundSides sides) {
	return !slope_range(rules, sides).is_unlimited() || rules.slope_curve != nullptr || !rules.density_rules.empty() ||
			(rules.expression != nullptr && rules.expression->uses(ExpressionInput::slope));
}

Status PreparedRules::set(const Rules &rules, std::uint64_t seed, GroundSides sides, const Planet &planet) {
	if (const Status status = validate(rules); !status.ok()) {
		return status;
	}
	const Status status =
			guarded("rules", static_cast<double>(rules.fields.size() + rules.ground_textures.size()), [&] {
				rules_.fields.reserve(rules.fields.size());
				rules_.ground_textures.reserve(rules.ground_textures.size());
				rules_.density_rules.reserve(rules.density_rules.size());
				rules_ = rules; // The assignment cannot fail halfway, because the memory is reserved above.
			});
	if (!status.ok()) {
		return status;
	}
	sides_ = sides;
	planet_ = planet;
	slope_ = slope_range(rules, sides);
	needs_slope_ = thicket::needs_slope(rules, sides);
	height_ = PreparedRange(rules.min_height, rules.min_height <= -unlimited_height, rules.max_height,
			rules.max_height >= unlimited_height, rules.height_falloff);
	water_depth_ = PreparedRange(rules.min_water_depth, rules.min_water_depth <= -unlimited_height,
			rules.max_water_depth, rules.max_water_depth >= unlimited_height, rules.water_depth_falloff);
	const bool dry = rules.water == nullptr && rules.min_water_depth <= -unlimited_height;
	slope_alone_ = height_.is_unlimited() && rules.height_curve == nullptr && rules.slope_curve == nullptr &&
			rules.ground_textures.empty() && rules.expression == nullptr && rules.density_rules.empty() &&
			(dry || water_depth_.is_unlimited());
	clumps_.set(rules.clumping, seed);
	constexpr std::uint64_t other_than_clumps = 0x8cb92ba72f3d8dd7;
	expression_seed_ = split_mix(seed ^ other_than_clumps);
	return {};
}

template <class Record>
Status PreparedRules::position_product(const PositionBatch &batch, std::span<double> r_densities,
		std::vector<float> &scratch, const Record &record) const {
	std::fill(r_densities.begin(), r_densities.end(), record(RuleKind::density, rules_.density, rules_.density));
	const std::size_t size = batch.positions.size();
	const auto count = static_cast<double>(size);
	if (const Status status = guarded("positions", count, [&] { scratch.resize(size); }); !status.ok()) {
		return status;
	}
	// The fields are multiplied one after another, because rounding depends on the order.
	for (std::size_t field = 0; field < rules_.fields.size(); ++field) {
		const auto sample = [&](std::span<float> r_values) {
			return rules_.fields[field]->sample_at(batch, r_values);
		};
		if (const Status status = multiply(sample, r_densities, scratch, record, RuleKind::field, field);
				!status.ok()) {
			return status;
		}
	}
	const auto multiply_map = [&](const auto &map, RuleKind kind) {
		const auto sample = [&](std::span<float> r_values) {
			return planet_.exists() ? map->sample_on(planet_, batch, r_values) : map->sample_at(batch, r_values);
		};
		return map != nullptr ? multiply(sample, r_densities, scratch, record, kind, no_index) : Status();
	};
	if (const Status status = multiply_map(rules_.mask, RuleKind::mask); !status.ok()) {
		return status;
	}
	if (const Status status = multiply_map(rules_.biome, RuleKind::biome); !status.ok()) {
		return status;
	}
	for (std::size_t i = 0; clumps_.active() && i < size; ++i) {
		if (!Record::complete && !(r_densities[i] > 0.0)) {
			// A density of 0 stays 0, and clump noise costs more than all other rules here.
			continue;
		}
		const double density = batch.in_space() ? clumps_.at(batch.in_space(i)) : clumps_.at(batch.positions[i]);
		r_densities[i] *= record(RuleKind::clumping, density, density);
	}
	return {};
}

Status PreparedRules::position_densities(
		const PositionBatch &batch, std::span<double> r_densities, std::vector<float> &scratch) const {
	return position_product(batch, r_densities, scratch, NoRecord());
}

Status PreparedRules::position_factors(const PositionBatch &batch, const RuleRecord &record) const {
	double product = 0.0;
	std::vector<float> scratch;
	return position_product<RuleRecord>(batch, {&product, 1}, scratch, record);
}

Status PreparedRules::find_closed(const TileSpace &space, bool &r_closed) const {
	r_closed = closed_in(space);
	const Box3 box{{space.min.x, std::max(space.bottom, -unlimited_height), space.min.y},
			{space.max.x, std::min(space.top, unlimited_height), space.max.y}};
	for (const SharedDensityRule &rule : rules_.density_rules) {
		if (r_closed || !rule->is_thread_safe()) {
			continue;
		}
		if (const Status status = rule->find_closed(box, r_closed); !status.ok()) {
			return status;
		}
	}
	return {};
}

/// Returns the water level at a world position, or no_water.
double PreparedRules::water_level_at(const glm::dvec3 &position) const {
	if (rules_.water == nullptr) {
		return no_water;
	}
	return planet_.exists() ? rules_.water->at(planet_, position) : rules_.water->at({position.x, position.z});
}

/// Returns the density of the water depth rule. Without water, the depth is minus infinity.
template <class Record>
double PreparedRules::water_density(double height, const glm::dvec3 &position, const Record &record) const {
	if (water_depth_.is_unlimited()) {
		// Every depth passes, so the water level is not needed.
		return 1.0;
	}
	const double level = water_level_at(position);
	if (level <= no_water && rules_.min_water_depth <= -unlimited_height) {
		return 1.0;
	}
	return record(RuleKind::water_depth, level - height, water_depth_.density(level - height));
}

/// Returns the density of the expression, which must exist.
template <class Record>
double PreparedRules::expression_density(
		const Ground &ground, const glm::dvec3 &position, const Record &record, std::span<const float> world) const {
	ExpressionInputs inputs{.height = ground.height, .position = position, .world = world};
	if (expression_uses(ExpressionInput::slope)) {
		inputs.slope = slope_degrees(ground.normal);
	}
	if (expression_uses(ExpressionInput::water_depth)) {
		inputs.water_depth = water_level_at(position) - inputs.height;
	}
	const double value = rules_.expression->at(inputs, expression_seed_, sides_ == GroundSides::all);
	return record(RuleKind::expression, value, value > 0.0 ? std::min(value, 1.0) : 0.0);
}

/// Returns the density of the ground at a position on the planet, which must exist.
template <class Record>
double PreparedRules::density_on_planet(
		const Ground &ground, glm::dvec2 position, const Record &record, std::span<const float> world) const {
	const glm::dvec3 in_world(position.x, ground.height, position.y);
	return density_of_limits(on_planet(planet_, position, ground), in_world, record, world);
}

/// Evaluates ground in the frame of the planet, if there is one. `position` is in world meters.
template <class Record>
double PreparedRules::density_of_limits(
		const Ground &ground, const glm::dvec3 &position, const Record &record, std::span<const float> world) const {
	if (!is_ground(ground, sides_)) {
		return record(RuleKind::ground, ground.height, 0.0);
	}
	double density = 1.0;
	if (!height_.is_unlimited()) {
		density = record(RuleKind::height, ground.height, height_.density(ground.height));
	}
	if (rules_.height_curve != nullptr) {
		density *= record(RuleKind::height_curve, ground.height, rules_.height_curve->at(ground.height));
	}
	if (!rules_.ground_textures.empty()) {
		density *= record(RuleKind::ground_textures, ground.weight, unit_density(ground.weight));
	}
	if (!Record::complete && !(density > 0.0)) {
		// A density of 0 stays 0, so water and slope are not needed.
		return density;
	}
	density *= water_density(ground.height, position, record);
	if (!Record::complete && !(density > 0.0)) {
		// A density of 0 stays 0, so the slope is not needed.
		return density;
	}
	if (!Record::complete && rules_.slope_curve == nullptr) {
		// Most slope limits need no angle.
		density *= slope_.density_of(ground.normal);
	} else if (!slope_.is_unlimited() || rules_.slope_curve != nullptr) {
		// Computing the angle costs more than all other rules here, so it is computed only if needed.
		const double slope = slope_degrees(ground.normal);
		if (!slope_.is_unlimited()) {
			density *= record(RuleKind::slope, slope, slope_.density(slope));
		}
		if (rules_.slope_curve != nullptr) {
			density *= record(RuleKind::slope_curve, slope, rules_.slope_curve->at(slope));
		}
	}
	if (rules_.expression != nullptr && (Record::complete || density > 0.0)) {
		density *= expression_density(ground, position, record, world);
	}
	if constexpr (Record::complete) {
		float product = 1.0f;
		for (std::uint32_t rule = 0; rule < record.density_rules().size(); ++rule) {
			const double factor = record.density_rules()[rule];
			product *= static_cast<float>(record(RuleKind::density_rule, factor, factor, rule));
		}
		density *= double{product};
	} else if (!rules_.density_rules.empty()) {
		density *= double{ground.density};
	}
	return density;
}

template <class Record>
double PreparedRules::shape_density(std::span<const std::uint32_t> nearby_shapes, glm::dvec2 position,
		const Ground &ground, const Record &record) const {
	if (rules_.shapes == nullptr) {
		return 1.0;
	}
	const ShapeEffect effect = rules_.shapes->effect(nearby_shapes, {position.x, double{ground.height}, position.y});
	return record(RuleKind::shapes, effect.density(), effect.density(), effect.decisive());
}

template double PreparedRules::density_on_planet(
		const Ground &, glm::dvec2, const NoRecord &, std::span<const float>) const;
template double PreparedRules::density_on_planet(
		const Ground &, glm::dvec2, const RuleRecord &, std::span<const float>) const;
template double PreparedRules::density_of_limits(
		const Ground &, const glm::dvec3 &, const NoRecord &, std::span<const float>) const;
template double PreparedRules::density_of_limits(
		const Ground &, const glm::dvec3 &, const RuleRecord &, std::span<const float>) const;
template double PreparedRules::shape_density(
		std::span<const std::uint32_t>, glm::dvec2, const Ground &, const NoRecord &) const;
template double PreparedRules::shape_density(
		std::span<const std::uint32_t>, glm::dvec2, const Ground &, const RuleRecord &) const;

} // namespace thicket
