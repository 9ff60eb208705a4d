#pragma once

#include "core/base/word_hash.hpp"
#include "core/surface/surface_sampler.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace thicket::analysis {

/// Returns a cube projected onto a sphere, so that its triangles face all directions. The function
/// uses no trigonometric functions, whose results depend on the C library.
inline std::shared_ptr<const Surface> golden_ball(
		const glm::dvec3 &middle, double radius, void (*require)(const Status &)) {
	constexpr std::uint32_t count = 24;
	std::vector<glm::dvec3> vertices;
	std::vector<std::uint32_t> indices;
	for (int side = 0; side < 6; ++side) {
		for (std::uint32_t v = 0; v <= count; ++v) {
			for (std::uint32_t u = 0; u <= count; ++u) {
				glm::dvec3 at(side < 3 ? 1.0 : -1.0);
				at[(side + 1) % 3] = 2.0 * u / count - 1.0;
				at[(side + 2) % 3] = 2.0 * v / count - 1.0;
				vertices.push_back(middle + at * (radius / std::sqrt(at.x * at.x + at.y * at.y + at.z * at.z)));
			}
		}
		for (std::uint32_t v = 0; v < count; ++v) {
			for (std::uint32_t u = 0; u < count; ++u) {
				const std::uint32_t first = (static_cast<std::uint32_t>(side) * (count + 1) + v) * (count + 1) + u;
				const std::uint32_t next = first + count + 1;
				indices.insert(indices.end(), {first, first + 1, next, first + 1, next + 1, next});
			}
		}
	}
	std::shared_ptr<const Surface> result;
	require(Surface::create(std::move(vertices), std::move(indices), result));
	return result;
}

inline std::uint64_t digest(std::vector<SurfacePoint> points) {
	std::ranges::sort(points, {}, &SurfacePoint::id);
	WordHash hash;
	for (const SurfacePoint &point : points) {
		hash.add(point.id);
		for (int side = 0; side < 3; ++side) {
			hash.add(point.position[side]);
			hash.add(point.normal[side]);
		}
		hash.add(std::uint64_t{point.rank} << 32 | point.level);
		hash.add(std::uint64_t{point.triangle});
	}
	return hash.value();
}

/// Returns digests of points on surfaces: smooth and angular ones, with one and several levels, in
/// windows, and far from the origin.
inline std::vector<std::pair<std::string, std::uint64_t>> surface_digests(void (*require)(const Status &)) {
	std::vector<std::pair<std::string, std::uint64_t>> digests;
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points;
	const auto add = [&](const char *name, const PointSet &set, const glm::dvec3 &middle, double radius) {
		const auto surface = golden_ball(middle, radius, require);
		require(sampler.sample_all(set, *surface, points));
		digests.emplace_back(std::string("surface, ") + name, digest(points));
		require(sampler.sample(set, *surface, {middle - radius, middle + radius * 0.4}, points));
		digests.emplace_back(std::string("surface, ") + name + ", window", digest(points));
	};
	add("ball", {.seed = 21}, {0.4, -0.7, 0.2}, 20.0);
	add("ball with three levels", {.seed = 22, .radius = 0.8, .levels = 3, .layer = 4}, {3.0, 2.0, 1.0}, 25.0);
	add("ball with corners", {.seed = 23, .radius = 6.0}, {0.0, 0.0, 0.0}, 12.0);
	add("ball, 5 000 km out", {.seed = 24, .radius = 2.0}, {5.0e6, 1000.0, -4.9e6}, 40.0);
	return digests;
}

} // namespace thicket::analysis
