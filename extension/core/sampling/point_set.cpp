#include "core/sampling/point_set.hpp"

#include <cmath>

namespace thicket {

Status validate(const PointSet &set) {
	if (!std::isfinite(set.radius)) {
		return {ErrorCode::not_finite, "radius", set.radius};
	}
	if (set.radius <= 0.0) {
		return {ErrorCode::not_positive, "radius", set.radius};
	}
	if (set.radius < min_radius || set.radius > max_radius) {
		return {ErrorCode::out_of_range, "radius", set.radius};
	}
	if (set.levels < 1 || set.levels > max_levels) {
		return {ErrorCode::out_of_range, "levels", static_cast<double>(set.levels)};
	}
	return {};
}

double lattice_unit(const PointSet &set) {
	constexpr double sqrt_2 = 1.4142135623730951;
	return set.radius / sqrt_2 / (1u << lattice_bits);
}

glm::i64vec2 lattice_position(const PointSet &set, const SamplePoint &point) {
	const double unit = lattice_unit(set);
	return {static_cast<std::int64_t>(std::floor(point.position.x / unit + 0.5)),
			static_cast<std::int64_t>(std::floor(point.position.y / unit + 0.5))};
}

} // namespace thicket
