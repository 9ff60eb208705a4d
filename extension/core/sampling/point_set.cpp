#include "core/sampling/point_set.hpp"

#include "core/base/check.hpp"
#include "core/base/instance_id.hpp"

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

Rect cell_rect(const PointSet &set, std::uint64_t id) {
	const double unit = lattice_unit(set);
	const glm::dvec2 corner = glm::dvec2(unpack(id).cell) * static_cast<double>(1u << lattice_bits);
	return {(corner - 1.0) * unit, (corner + static_cast<double>((1u << lattice_bits) + 1)) * unit};
}

} // namespace thicket
