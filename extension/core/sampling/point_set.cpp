#include "core/sampling/point_set.hpp"

#include "core/base/check.hpp"
#include "core/base/instance_id.hpp"

#include <cmath>
#include <numbers>

namespace thicket {

Status validate(const PointSet &set) {
	const Status status = first_failure(check_positive("radius", set.radius),
			check_range("radius", set.radius, min_radius, max_radius),
			check_range("levels", set.levels, 1, max_levels));
	if (!status.ok()) {
		return status;
	}
	const std::int32_t step = period_step(set.levels);
	for (const std::int32_t cells : {set.period.x, set.period.y}) {
		if (cells < 0 || cells > cell_limit || cells % step != 0) {
			return Status::out_of_range("period", cells, between(0, cell_limit, "in cells of radius / sqrt(2)"),
					"Use a multiple of 5 * 2^(levels - 1) cells, or 0 for an infinite set");
		}
	}
	return {};
}

double lattice_unit(const PointSet &set) { return set.radius / std::numbers::sqrt2 / (1u << lattice_bits); }

glm::i64vec2 lattice_position(const PointSet &set, const SamplePoint &point) {
	const double unit = lattice_unit(set);
	return {static_cast<std::int64_t>(std::floor(point.position.x / unit + 0.5)),
			static_cast<std::int64_t>(std::floor(point.position.y / unit + 0.5))};
}

double id_cell_side(const PointSet &set) {
	return set.on_surface ? set.radius / std::numbers::sqrt3 / surface_id_steps
						  : lattice_unit(set) * (1u << lattice_bits);
}

double set_extent(const PointSet &set) { return id_cell_side(set) * cell_limit; }

Rect cell_rect(const PointSet &set, std::uint64_t id) {
	if (set.on_surface) {
		// The range has one part more than the cell on each side to cover rounding.
		const glm::ivec2 first = unpack(id).cell & ~(surface_id_steps - 1);
		const double side = id_cell_side(set);
		return {glm::dvec2(first - 1) * side, glm::dvec2(first + surface_id_steps + 1) * side};
	}
	const double unit = lattice_unit(set);
	const glm::dvec2 corner = glm::dvec2(unpack(id).cell) * static_cast<double>(1u << lattice_bits);
	return {(corner - 1.0) * unit, (corner + static_cast<double>((1u << lattice_bits) + 1)) * unit};
}

CellHeights cell_heights(const PointSet &set, std::uint64_t id) {
	constexpr std::int32_t steps = surface_id_steps - 1;
	const glm::ivec2 packed = unpack(id).cell;
	const std::int32_t bits = (packed.x & steps) << surface_id_step_bits | (packed.y & steps);
	const std::int32_t cell = (bits ^ surface_id_height) - surface_id_height; // Extends the sign.
	const double part = id_cell_side(set);
	const double side = part * surface_id_steps;
	return {cell * side - part, (cell + 1.0) * side + part};
}

} // namespace thicket
