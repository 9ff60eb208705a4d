#pragma once

#include "core/surface/surface_sampler.hpp"

#include <doctest/doctest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket::surfaces {

struct Triangles {
	std::vector<glm::dvec3> vertices;
	std::vector<std::uint32_t> indices;

	std::shared_ptr<const Surface> surface() const {
		std::shared_ptr<const Surface> result;
		REQUIRE(Surface::create(vertices, indices, result).ok());
		return result;
	}

	void add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
		for (const std::uint32_t index : {a, b, c, b, d, c}) {
			indices.push_back(index);
		}
	}

	void append(const Triangles &other) {
		const auto first = static_cast<std::uint32_t>(vertices.size());
		vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
		for (const std::uint32_t index : other.indices) {
			indices.push_back(first + index);
		}
	}
};

/// Returns a square with a corner at `origin` and its edges along two unit vectors, divided into
/// `count` x `count` quads.
inline Triangles square(double size, std::uint32_t count, const glm::dvec3 &origin, const glm::dvec3 &u_axis,
		const glm::dvec3 &v_axis) {
	Triangles triangles;
	for (std::uint32_t y = 0; y <= count; ++y) {
		for (std::uint32_t x = 0; x <= count; ++x) {
			triangles.vertices.push_back(origin + u_axis * (size * x / count) + v_axis * (size * y / count));
		}
	}
	for (std::uint32_t y = 0; y < count; ++y) {
		for (std::uint32_t x = 0; x < count; ++x) {
			const std::uint32_t corner = y * (count + 1) + x;
			triangles.add_quad(corner, corner + 1, corner + count + 1, corner + count + 2);
		}
	}
	return triangles;
}

/// Returns a square that faces `normal`, with a corner near the origin.
inline Triangles facing(const glm::dvec3 &normal, double size, std::uint32_t count) {
	const glm::dvec3 unit = glm::normalize(normal);
	const glm::dvec3 other = std::abs(unit.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
	const glm::dvec3 along = glm::normalize(glm::cross(unit, other));
	return square(size, count, {0.3, 0.1, 0.2}, along, glm::cross(unit, along));
}

/// Returns a sphere around the origin with 4 * count^2 triangles, including the degenerate ones at
/// its poles.
inline Triangles sphere(double radius, std::uint32_t count) {
	Triangles triangles;
	const double pi = 3.14159265358979323846;
	for (std::uint32_t y = 0; y <= count; ++y) {
		for (std::uint32_t x = 0; x <= 2 * count; ++x) {
			const double polar = pi * y / count;
			const double longitude = pi * (x % (2 * count)) / count;
			triangles.vertices.push_back(radius *
					glm::dvec3(std::sin(polar) * std::cos(longitude), std::cos(polar),
							std::sin(polar) * std::sin(longitude)));
		}
	}
	const std::uint32_t row = 2 * count + 1;
	for (std::uint32_t y = 0; y < count; ++y) {
		for (std::uint32_t x = 0; x < 2 * count; ++x) {
			triangles.add_quad(y * row + x, y * row + x + 1, (y + 1) * row + x, (y + 1) * row + x + 1);
		}
	}
	return triangles;
}

inline std::vector<SurfacePoint> all_points(const PointSet &set, const Surface &surface) {
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points;
	REQUIRE(sampler.sample_all(set, surface, points).ok());
	return points;
}

inline void sort_by_id(std::vector<SurfacePoint> &r_points) { std::ranges::sort(r_points, {}, &SurfacePoint::id); }

/// A spatial hash of points. Its cubes are one radius wide.
class PointCubes {
public:
	PointCubes(const std::vector<SurfacePoint> &points, double radius) : points_(points), radius_(radius) {
		for (std::size_t index = 0; index < points.size(); ++index) {
			cubes_[cube(points[index].position)].push_back(index);
		}
	}

	/// Returns the distance to the nearest point other than `self`, or infinity if the 27 cubes
	/// around the position contain no other point.
	double nearest(const glm::dvec3 &position, std::size_t self = ~std::size_t{0}) const {
		double min_distance = std::numeric_limits<double>::infinity();
		each_near(position, [&](std::size_t index) {
			if (index != self) {
				min_distance = std::min(min_distance, glm::distance(points_[index].position, position));
			}
		});
		return min_distance;
	}

	std::size_t count_within(const glm::dvec3 &position, double distance) const {
		std::size_t count = 0;
		each_near(position, [&](std::size_t index) {
			count += glm::distance(points_[index].position, position) < distance ? 1 : 0;
		});
		return count;
	}

private:
	std::tuple<int, int, int> cube(const glm::dvec3 &position) const {
		const glm::ivec3 at(glm::floor(position / radius_));
		return {at.x, at.y, at.z};
	}

	template <typename Visit>
	void each_near(const glm::dvec3 &position, Visit visit) const {
		const auto [x, y, z] = cube(position);
		for (int cube_index = 0; cube_index < 27; ++cube_index) {
			const auto entry =
					cubes_.find({x + cube_index % 3 - 1, y + cube_index / 3 % 3 - 1, z + cube_index / 9 - 1});
			for (const std::size_t index : entry != cubes_.end() ? entry->second : std::vector<std::size_t>()) {
				visit(index);
			}
		}
	}

	const std::vector<SurfacePoint> &points_;
	double radius_;
	std::map<std::tuple<int, int, int>, std::vector<std::size_t>> cubes_;
};

/// Returns the fraction of the surface's area that disks of half the radius around the points would
/// cover.
inline double coverage(const PointSet &set, const Surface &surface, std::size_t points) {
	return static_cast<double>(points) * 3.14159265358979323846 * set.radius * set.radius / 4.0 / surface.area();
}

} // namespace thicket::surfaces
