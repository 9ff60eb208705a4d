#include "core/rules/shape.hpp"

#include "core/base/check.hpp"
#include "core/rules/planet_map.hpp"
#include "core/rules/shape_volume.hpp"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

constexpr double axes_tolerance = 1e-6;

/// Limit for half the width of a path on a planet, in radii of the planet.
constexpr double widest_path = 0.5;

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

Status check_outline(const std::vector<glm::dvec2> &outline, std::size_t min_points) {
	if (outline.size() < min_points || outline.size() > max_outline_points) {
		return Status::wrong_size("outline", outline.size(), between(min_points, max_outline_points, "points"));
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

/// Returns an error for a position on a planet's map that is too far from the map's middle.
Status check_on_map(const Shape &shape) {
	const PlanetMap map(shape.planet, shape.center);
	for (const glm::dvec2 position : shape.outline) {
		if (!map.contains(position)) {
			return Status::out_of_range("distance of the outline from its middle",
					std::sqrt(position.x * position.x + position.y * position.y) / shape.planet.radius,
					at_most(PlanetMap::radii_across, "radii of the planet, on its map"), "Divide the region in two");
		}
	}
	return shape.kind == ShapeKind::path
			? check_range("half_width", shape.half_size.x, 0.0, widest_path * shape.planet.radius)
			: Status{};
}

Status check_planet(const Shape &shape) {
	const Planet &planet = shape.planet;
	if (!planet.exists()) {
		return {};
	}
	const Status status = first_failure(check_coordinate("planet_radius", planet.radius),
			check_coordinate("planet_center", planet.center.x), check_coordinate("planet_center", planet.center.y),
			check_coordinate("planet_center", planet.center.z), check_coordinate("center", shape.center.x),
			check_coordinate("center", shape.center.y), check_coordinate("center", shape.center.z));
	if (!status.ok()) {
		return status;
	}
	if (shape.center == planet.center) {
		return {ErrorCode::not_positive, "distance from the planet's center", 0.0, {}, {},
				"Move the region to the ground, or disable ignore_height"};
	}
	return check_on_map(shape);
}

/// Returns the world rectangle of all directions from the planet's center whose angle to `axis` has a
/// cosine of at least `cosine`, up to Planet::radii_around radii from the center.
Rect cone(const Planet &planet, const glm::dvec3 &axis, double cosine) {
	const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
	// Returns the largest component of these directions along a unit vector, or 0 if all are negative.
	// `along` is the component of the unit vector along `axis`.
	const auto farthest = [&](double along) {
		const double across = std::sqrt(std::max(0.0, 1.0 - along * along));
		return along >= cosine ? 1.0 : std::max(0.0, along * cosine + across * sine);
	};
	const double reach = Planet::radii_around * planet.radius;
	const glm::dvec2 center(planet.center.x, planet.center.z);
	return {center - reach * glm::dvec2(farthest(-axis.x), farthest(-axis.z)),
			center + reach * glm::dvec2(farthest(axis.x), farthest(axis.z))};
}

Rect with(const Rect &a, const Rect &b) {
	return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
			{std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}};
}

/// Returns a lower bound of the cosine of an angle in radians.
double min_cosine(double angle) { return angle < 2.0 ? 1.0 - 0.5 * angle * angle : -1.0; }

/// Returns the bounds of a path on a planet, which are the bounds of its edges.
Rect path_bounds(const Shape &shape, const PlanetMap &map) {
	// At the border of the map, the scale may differ by this factor between the ends of an edge. An
	// arc is at most pi / 2 times as long as its chord.
	constexpr double longest = 4.0 * 1.6;
	const std::vector<glm::dvec2> &line = shape.outline;
	Rect result = cone(shape.planet, map.direction(line.front()), 1.0);
	for (std::size_t i = 0; i + 1 < line.size(); ++i) {
		const glm::dvec2 edge = line[i + 1] - line[i];
		const double length = 0.5 * std::sqrt(edge.x * edge.x + edge.y * edge.y) + longest * shape.half_size.x;
		const glm::dvec3 middle = map.direction(0.5 * (line[i] + line[i + 1]));
		result = with(result, cone(shape.planet, middle, min_cosine(length / shape.planet.radius)));
	}
	return result;
}

Rect planet_bounds(const Shape &shape) {
	const PlanetMap map(shape.planet, shape.center);
	if (shape.kind == ShapeKind::path) {
		return path_bounds(shape, map);
	}
	double cosine = 1.0;
	if (shape.kind == ShapeKind::polygon) {
		for (const glm::dvec2 corner : shape.outline) {
			const double scale = map.scale(corner);
			cosine = std::min(cosine, (2.0 - scale) / scale);
		}
	} else {
		const glm::dvec2 reach = ShapeVolume(rotated_upright(shape, map)).reach();
		const double sine = std::sqrt(reach.x * reach.x + reach.y * reach.y) / map.middle_distance();
		cosine = sine < 1.0 ? std::sqrt(1.0 - sine * sine) : 0.0;
	}
	constexpr double tolerance = 1e-9;
	return cone(shape.planet, map.axes()[1], cosine - tolerance);
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
	if (shape.planet.exists()) {
		return planet_bounds(shape);
	}
	if (shape.kind == ShapeKind::polygon || shape.kind == ShapeKind::path) {
		const Rect points = around(shape.outline);
		const double reach = shape.kind == ShapeKind::path ? shape.half_size.x : 0.0;
		return expanded(points, reach);
	}
	const glm::dvec2 center(shape.center.x, shape.center.z);
	const glm::dvec2 reach = ShapeVolume(shape).reach();
	return {center - reach, center + reach};
}

} // namespace

Status validate(const Shape &shape) {
	return first_failure(
			check_range("falloff", shape.falloff, 0.0, max_shape_coordinate), check_kind(shape), check_planet(shape));
}

Shape rotated_upright(const Shape &shape, const PlanetMap &map) {
	Shape rotated = shape;
	rotated.center = glm::dvec3(0.0);
	rotated.axes = glm::transpose(map.axes()) * shape.axes;
	rotated.planet = {};
	return rotated;
}

Rect bounds(const Shape &shape) {
	constexpr double tolerance = 1e-12;
	const Rect tight = tight_bounds(shape);
	const glm::dvec2 margin(tolerance * std::max(std::abs(tight.min.x), std::abs(tight.max.x)),
			tolerance * std::max(std::abs(tight.min.y), std::abs(tight.max.y)));
	return {tight.min - margin, tight.max + margin};
}

} // namespace thicket
