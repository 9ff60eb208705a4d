#include "core/sampling/domain/domain.hpp"

#include "core/base/check.hpp"
#include "core/sampling/point_set.hpp"

#include <limits>

namespace thicket {

namespace {

Status validate_size(const DomainRequest &request) {
	for (const double side : {request.size.x, request.size.y}) {
		if (const Status status = check_positive("size", side); !status.ok()) {
			return status;
		}
		if (request.toroidal && side < min_torus_radii * request.radius) {
			return {ErrorCode::out_of_range, "size", side};
		}
	}
	const double expected = request.size.x * request.size.y * point_density({.radius = request.radius});
	if (!(expected <= max_domain_points)) {
		return {ErrorCode::too_many_points, "size", expected};
	}
	return {};
}

} // namespace

Status validate(const DomainRequest &request) {
	const Status numbers = first_failure(check_positive("radius", request.radius),
			check_range("radius", request.radius, min_radius, max_radius),
			check_range("cell_size", request.cell_size, 0.0, max_cell_size),
			check_range("darts_each", request.darts_each, 1.0, 1e6));
	return numbers.ok() ? validate_size(request) : numbers;
}

} // namespace thicket
