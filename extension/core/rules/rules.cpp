#include "core/rules/rules.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/rules/instance_random.hpp"
#include "core/rules/slope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

constexpr double max_slope = 90.0;

Status check_height(const char *property, double height) {
	// Infinity is a fair way to say "no limit" in a computation, but a slip in a setting.
	return check_range(property, height, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

bool is_ground(const Ground &ground) {
	return std::isfinite(ground.height) && std::isfinite(ground.normal.x) && std::isfinite(ground.normal.y) &&
			std::isfinite(ground.normal.z) && ground.normal.y > 0.0f;
}

} // namespace

Status validate(const Rules &rules) {
	return first_failure(check_range("density", rules.density, 0.0, 1.0),
			check_range("min_slope_degrees", rules.min_slope_degrees, 0.0, max_slope),
			check_range("max_slope_degrees", rules.max_slope_degrees, 0.0, max_slope),
			check_order("max_slope_degrees", rules.min_slope_degrees, rules.max_slope_degrees),
			check_range("slope_falloff", rules.slope_falloff, 0.0, max_slope),
			check_height("min_height", rules.min_height), check_height("max_height", rules.max_height),
			check_order("max_height", rules.min_height, rules.max_height),
			check_range("height_falloff", rules.height_falloff, 0.0, std::numeric_limits<double>::max()));
}

PreparedRange::PreparedRange(double min, bool min_open, double max, bool max_open, double falloff) :
		min_(min), max_(max), falloff_(falloff), min_open_(min_open), max_open_(max_open) {}

double PreparedRange::chance(double value) const {
	const bool inside = (min_open_ || value >= min_) && (max_open_ || value <= max_);
	if (!inside || std::isnan(value)) {
		return 0.0;
	}
	if (falloff_ <= 0.0) {
		return 1.0;
	}
	const double above = min_open_ ? 1.0 : (value - min_) / falloff_;
	const double below = max_open_ ? 1.0 : (max_ - value) / falloff_;
	return std::min({above, below, 1.0});
}

Status PreparedRules::set(const Rules &rules) {
	if (const Status status = validate(rules); !status.ok()) {
		return status;
	}
	rules_ = rules;
	// Whole ranks below density * 2^32, which is exact.
	rank_end_ = static_cast<std::uint64_t>(std::ceil(rules.density * 0x1p32));
	slope_ = PreparedRange(rules.min_slope_degrees, rules.min_slope_degrees <= 0.0, rules.max_slope_degrees,
			rules.max_slope_degrees >= max_slope, rules.slope_falloff);
	height_ = PreparedRange(rules.min_height, rules.min_height <= -unlimited_height, rules.max_height,
			rules.max_height >= unlimited_height, rules.height_falloff);
	return {};
}

bool PreparedRules::passes_ground(const Ground &ground, std::uint64_t id, std::uint64_t seed) const {
	if (!is_ground(ground)) {
		return false;
	}
	const double height_chance = height_.chance(ground.height);
	if (height_chance <= 0.0) {
		return false;
	}
	// The angle costs more than all else here, so only where it is asked for.
	const double slope_chance = slope_.open() ? 1.0 : slope_.chance(slope_degrees(ground.normal));
	if (slope_chance <= 0.0) {
		return false;
	}
	if (height_chance >= 1.0 && slope_chance >= 1.0) {
		return true;
	}
	const auto random = instance_random(seed, id, Draw::rules);
	return unit_interval(random[0]) < slope_chance && unit_interval(random[1]) < height_chance;
}

} // namespace thicket
