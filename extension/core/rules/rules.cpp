#include "core/rules/rules.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/base/trigonometry.hpp"

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

Status multiply(const DensityField &field, std::span<const glm::dvec2> positions, std::span<double> r_densities,
		std::span<float> scratch) {
	const Status status = field.sample(positions, scratch);
	for (std::size_t i = 0; status.ok() && i < positions.size(); ++i) {
		r_densities[i] *= unit_density(scratch[i]);
	}
	return status;
}

} // namespace

Status validate(const Rules &rules) {
	const bool null_field = std::find(rules.fields.begin(), rules.fields.end(), nullptr) != rules.fields.end();
	return first_failure(check_range("density", rules.density, 0.0, 1.0),
			check_range("min_slope_degrees", rules.min_slope_degrees, 0.0, max_slope),
			check_range("max_slope_degrees", rules.max_slope_degrees, 0.0, max_slope),
			check_order("max_slope_degrees", rules.min_slope_degrees, rules.max_slope_degrees),
			check_range("slope_falloff", rules.slope_falloff, 0.0, max_slope),
			check_height("min_height", rules.min_height), check_height("max_height", rules.max_height),
			check_order("max_height", rules.min_height, rules.max_height),
			check_range("height_falloff", rules.height_falloff, 0.0, std::numeric_limits<double>::max()),
			validate(rules.clumping), check_range("edge_feather", rules.edge_feather, 0.0, max_edge_feather),
			null_field ? Status{ErrorCode::missing, "fields", 0.0} : Status{});
}

PreparedRange::PreparedRange(double min, bool min_open, double max, bool max_open, double falloff) :
		min_(min), max_(max), falloff_(falloff), min_open_(min_open), max_open_(max_open) {}

double PreparedRange::density(double value) const {
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

Status PreparedRules::set(const Rules &rules, std::uint64_t seed) {
	if (const Status status = validate(rules); !status.ok()) {
		return status;
	}
	const Status status =
			guarded("rules", static_cast<double>(rules.fields.size() + rules.ground_textures.size()), [&] {
				rules_.fields.reserve(rules.fields.size());
				rules_.ground_textures.reserve(rules.ground_textures.size());
				rules_ = rules; // Takes no memory now, so it is not left half done.
			});
	if (!status.ok()) {
		return status;
	}
	slope_ = PreparedRange(rules.min_slope_degrees, rules.min_slope_degrees <= 0.0, rules.max_slope_degrees,
			rules.max_slope_degrees >= max_slope, rules.slope_falloff);
	height_ = PreparedRange(rules.min_height, rules.min_height <= -unlimited_height, rules.max_height,
			rules.max_height >= unlimited_height, rules.height_falloff);
	clumps_.set(rules.clumping, seed);
	return {};
}

Status PreparedRules::place_densities(
		std::span<const glm::dvec2> positions, std::span<double> r_densities, std::vector<float> &scratch) const {
	std::fill(r_densities.begin(), r_densities.end(), rules_.density);
	const auto count = static_cast<double>(positions.size());
	if (const Status status = guarded("positions", count, [&] { scratch.resize(positions.size()); }); !status.ok()) {
		return status;
	}
	for (const std::shared_ptr<const DensityField> &field : rules_.fields) {
		if (const Status status = multiply(*field, positions, r_densities, scratch); !status.ok()) {
			return status;
		}
	}
	if (rules_.mask != nullptr) {
		if (const Status status = multiply(*rules_.mask, positions, r_densities, scratch); !status.ok()) {
			return status;
		}
	}
	// Clumps cost more than all else here, so only where anything is left.
	for (std::size_t i = 0; clumps_.active() && i < positions.size(); ++i) {
		if (r_densities[i] > 0.0) {
			r_densities[i] *= clumps_.at(positions[i]);
		}
	}
	return {};
}

double PreparedRules::ground_density(const Ground &ground) const {
	if (!is_ground(ground)) {
		return 0.0;
	}
	double density = height_.density(ground.height);
	if (rules_.height_curve != nullptr) {
		density *= rules_.height_curve->at(ground.height);
	}
	if (!rules_.ground_textures.empty()) {
		density *= unit_density(ground.weight);
	}
	// The angle costs more than all else here, so only where it is asked for.
	if (density > 0.0 && (!slope_.open() || rules_.slope_curve != nullptr)) {
		const double slope = slope_degrees(ground.normal);
		density *= slope_.density(slope);
		if (rules_.slope_curve != nullptr) {
			density *= rules_.slope_curve->at(slope);
		}
	}
	return density;
}

double PreparedRules::shape_density(
		std::span<const std::uint32_t> near, glm::dvec2 position, const Ground &ground) const {
	return rules_.shapes == nullptr ? 1.0
									: rules_.shapes->density(near, {position.x, double{ground.height}, position.y});
}

} // namespace thicket
