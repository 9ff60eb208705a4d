#include "core/sampling/domain/domain.hpp"

#include "core/base/check.hpp"
#include "core/sampling/point_set.hpp"

#include <string>
#include <string_view>

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
	const double expected = expected_points(request);
	if (!(expected <= max_domain_points)) {
		return Status::too_many_points("size", expected, max_domain_points);
	}
	return {};
}

} // namespace

double expected_points(const DomainRequest &request) {
	const glm::dvec2 radii = request.size / request.radius + (request.toroidal ? 0.0 : 1.0);
	return radii.x * radii.y * point_density({.radius = 1.0});
}

std::string describe(const DomainRequest &request, const Status &status) {
	std::string text = describe(status);
	if (status.code != ErrorCode::out_of_range || std::string_view(status.property) != "size") {
		return text;
	}
	if (request.toroidal && status.value < min_torus_radii * request.radius) {
		return text + "; a toroidal domain measures at least " + std::to_string(static_cast<int>(min_torus_radii)) +
				" radii on each axis";
	}
	return text + "; in single precision a domain measures at most " +
			std::to_string(static_cast<int>(max_single_radii)) + " radii";
}

Status validate(const DomainRequest &request) {
	const Status numbers = first_failure(check_positive("radius", request.radius),
			check_range("radius", request.radius, min_radius, max_radius),
			check_range("cell_size", request.cell_size, 0.0, max_cell_size),
			check_range("darts_each", request.darts_each, 1.0, 1e6));
	return numbers.ok() ? validate_size(request) : numbers;
}

} // namespace thicket
