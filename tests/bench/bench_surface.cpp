// Measures the speed of the surface sampler in points per second of CPU time, and the lines and
// darts per point. Covers planes in several directions, hills and spheres, with several triangle
// sizes and surface sizes. Prints rows of a Markdown table.
//   bench_surface [rounds = 9] [seconds a measurement = 0.25]

#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/timing.hpp"

#include "core/surface/surface_sampler.hpp"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace thicket::bench {
namespace {

struct Ground {
	std::string name;
	std::shared_ptr<const Surface> surface;
};

/// Returns a surface over a grid of (count + 1)^2 vertices, with two triangles per cell. `position`
/// maps grid coordinates to positions in meters.
template <typename Position>
std::shared_ptr<const Surface> grid(std::uint32_t count, Position &&position) {
	std::vector<glm::dvec3> vertices;
	std::vector<std::uint32_t> indices;
	for (std::uint32_t y = 0; y <= count; ++y) {
		for (std::uint32_t x = 0; x <= count; ++x) {
			vertices.push_back(position(static_cast<double>(x), static_cast<double>(y)));
		}
	}
	for (std::uint32_t y = 0; y < count; ++y) {
		for (std::uint32_t x = 0; x < count; ++x) {
			const std::uint32_t a = y * (count + 1) + x;
			const std::uint32_t b = a + count + 1;
			indices.insert(indices.end(), {a, a + 1, b, a + 1, b + 1, b});
		}
	}
	std::shared_ptr<const Surface> result;
	require(Surface::create(std::move(vertices), std::move(indices), result));
	return result;
}

std::shared_ptr<const Surface> plane(const glm::dvec3 &normal, double size, double step) {
	const glm::dvec3 unit = glm::normalize(normal);
	const glm::dvec3 tangent = glm::normalize(glm::cross(unit, glm::dvec3(0.0, 0.0, 1.0)));
	const glm::dvec3 bitangent = glm::cross(unit, tangent);
	return grid(static_cast<std::uint32_t>(size / step),
			[&](double x, double y) { return tangent * (x * step) + bitangent * (y * step); });
}

/// Returns hills with slopes of up to 60 degrees.
std::shared_ptr<const Surface> hills(double size, double step) {
	return grid(static_cast<std::uint32_t>(size / step), [step](double x, double y) {
		return glm::dvec3(x * step, 8.0 * std::sin(x * step / 6.5) * std::cos(y * step / 6.5), y * step);
	});
}

std::shared_ptr<const Surface> sphere(double radius, double step) {
	const auto count = static_cast<std::uint32_t>(std::numbers::pi * radius / step);
	return grid(count, [radius, count](double x, double y) {
		const double longitude = 2.0 * std::numbers::pi * x / count;
		const double latitude = std::numbers::pi * y / count;
		return radius *
				glm::dvec3(std::sin(latitude) * std::cos(longitude), std::cos(latitude),
						std::sin(latitude) * std::sin(longitude));
	});
}

std::vector<Ground> grounds() {
	return {
			{"plane, triangles of 2 m", plane({0.0, 1.0, 0.0}, 240.0, 2.0)},
			{"plane at 45 degrees, triangles of 2 m", plane({1.0, 1.0, 0.0}, 240.0, 2.0)},
			{"plane across (1, 1, 1), triangles of 2 m", plane({1.0, 1.0, 1.0}, 240.0, 2.0)},
			{"hills, triangles of 1 m", hills(200.0, 1.0)},
			{"hills, triangles of 2 m", hills(200.0, 2.0)},
			{"hills, triangles of 4 m", hills(200.0, 4.0)},
			{"hills of 4 times the area, triangles of 2 m", hills(400.0, 2.0)},
			{"sphere, triangles of 2 m", sphere(60.0, 2.0)},
	};
}

void run(const Effort &effort) {
	const std::vector<Ground> all = grounds();
	std::vector<Series> rates(all.size());
	std::vector<SurfaceStats> stats(all.size());
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points;
	for (int round = 0; round < effort.rounds; ++round) {
		for (std::size_t at = 0; at < all.size(); ++at) {
			rates[at].add(rate(effort.seconds, [&] {
				require(sampler.sample_all({.seed = 1}, *all[at].surface, points));
				return points.size();
			}));
			stats[at] = sampler.stats();
		}
	}
	for (std::size_t at = 0; at < all.size(); ++at) {
		const auto kept_count = static_cast<double>(stats[at].kept);
		print_row(all[at].name, rates[at], 1e-6, " M points/s", 3);
		print_count(all[at].name + ": points", kept_count, "", 0);
		print_count(all[at].name + ": points computed per point kept",
				static_cast<double>(stats[at].computed) / kept_count, "");
		print_count(all[at].name + ": lines without a point, per point",
				static_cast<double>(stats[at].lines) / kept_count, "");
		print_count(
				all[at].name + ": rejected darts, per point", static_cast<double>(stats[at].darts) / kept_count, "");
	}
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	thicket::bench::run(thicket::bench::effort_of(argument_count, arguments));
}
