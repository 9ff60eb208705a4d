#include "core/rules/shape.hpp"

#include "core/base/check.hpp"
#include "core/rules/shape_volume.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

constexpr double axes_tolerance = 1e-6;

Status check_coordinate(const char *property, double value) {
	return check_range(property, value, -max_shape_coordinate, max_shape_coordinate);
}

Status check_size(const char *property, double value) {
	return first_failure(check_positive(property, value), check_coordinate(property, value));
}

Status check_axes(const glm::dmat3 &axes) {
	for (int i = 0; i < 3; ++i) {
		for (int j = i; j < 3; ++j) {
			const glm::dvec3 a = axes[i];
			const glm::dvec3 b = axes[j];
			const double product = a.x * b.x + a.y * b.y + a.z * b.z;
			const double expected = i == j ? 1.0 : 0.0;
			if (const Status status =
							check_range("axes", product, expected - axes_tolerance, expected + axes_tolerance);
					!status.ok()) {
				return status;
			}
		}
	}
	return {};
}

Status check_position(const Shape &shape) {
	return first_failure(check_coordinate("center", shape.center.x), check_coordinate("center", shape.center.y),
			check_coordinate("center", shape.center.z),
			shape.kind == ShapeKind::sphere ? Status{} : check_axes(shape.axes));
}

Status check_outline(const std::vector<glm::dvec2> &outline, std::size_t least) {
	if (outline.size() < least || outline.size() > max_outline_points) {
		return Status::wrong_size("outline", outline.size(), between(least, max_outline_points, "points"));
	}
	for (const glm::dvec2 point : outline) {
		if (const Status status =
						first_failure(check_coordinate("outline", point.x), check_coordinate("outline", point.y));
				!status.ok()) {
			return status;
		}
	}
	return {};
}

Status check_kind(const Shape &shape) {
	switch (shape.kind) {
		case ShapeKind::box:
			return first_failure(check_position(shape), check_size("half_size", shape.half_size.x),
					check_size("half_size", shape.half_size.y), check_size("half_size", shape.half_size.z));
		case ShapeKind::sphere: return first_failure(check_position(shape), check_size("radius", shape.half_size.x));
		case ShapeKind::cylinder:
			return first_failure(check_position(shape), check_size("radius", shape.half_size.x),
					check_size("half_height", shape.half_size.y));
		case ShapeKind::polygon: return check_outline(shape.outline, 3);
		case ShapeKind::path:
			return first_failure(check_outline(shape.outline, 2), check_size("half_width", shape.half_size.x));
	}
	return Status::out_of_range("kind", static_cast<int>(shape.kind), between(0, static_cast<int>(ShapeKind::path)));
}

Rect around(const std::vector<glm::dvec2> &points) {
	Rect result{points.front(), points.front()};
	for (const glm::dvec2 point : points) {
		result.min = {std::min(result.min.x, point.x), std::min(result.min.y, point.y)};
		result.max = {std::max(result.max.x, point.x), std::max(result.max.y, point.y)};
	}
	return result;
}

Rect tight_bounds(const Shape &shape) {
	if (shape.kind == ShapeKind::polygon || shape.kind == ShapeKind::path) {
		const Rect points = around(shape.outline);
		const double reach = shape.kind == ShapeKind::path ? shape.half_size.x : 0.0;
		return {points.min - reach, points.max + reach};
	}
	const glm::dvec2 center(shape.center.x, shape.center.z);
	const glm::dvec2 reach = ShapeVolume(shape).reach();
	return {center - reach, center + reach};
}

} // namespace

Status validate(const Shape &shape) {
	return first_failure(check_range("falloff", shape.falloff, 0.0, max_shape_coordinate), check_kind(shape));
}

Rect bounds(const Shape &shape) {
	constexpr double hair = 1e-12;
	const Rect tight = tight_bounds(shape);
	const glm::dvec2 margin(hair * std::max(std::abs(tight.min.x), std::abs(tight.max.x)),
			hair * std::max(std::abs(tight.min.y), std::abs(tight.max.y)));
	return {tight.min - margin, tight.max + margin};
}

} // namespace thicket
