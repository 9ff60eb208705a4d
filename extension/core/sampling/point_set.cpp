#include "core/sampling/point_set.hpp"

#include "core/base/check.hpp"

#include <cmath>
#include <numbers>

namespace thicket {

Status validate(const PointSet &set) {
	return first_failure(check_positive("radius", set.radius),
			check_range("radius", set.radius, min_radius, max_radius),
			check_range("levels", set.levels, 1, max_levels));
}

double lattice_unit(const PointSet &set) { return set.radius / std::numbers::sqrt2 / (1u << lattice_bits); }

glm::i64vec2 lattice_position(const PointSet &set, const SamplePoint &point) {
	const double unit = lattice_unit(set);
	return {static_cast<std::int64_t>(std::floor(point.position.x / unit + 0.5)),
			static_cast<std::int64_t>(std::floor(point.position.y / unit + 0.5))};
}

} // namespace thicket
