#include "tests/cost/growth.hpp"

#include "core/terrain/triangle_terrain.hpp"

#include <array>

namespace thicket::cost {

namespace {

/// Returns the steps that it takes to set the triangles of a terrain and to sample the terrain. Each
/// triangle is small and at a point of the recipe, or long and near three points.
std::uint64_t mesh(const Recipe &recipe, std::size_t count, bool longish) {
	const Points points = recipe.points(3 * count);
	std::vector<glm::dvec3> corners;
	for (std::size_t i = 0; i < count; ++i) {
		const double height = static_cast<double>(i % 7);
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const glm::dvec2 point = longish ? points[3 * i + corner] : points[i];
			corners.emplace_back(point.x + (corner == 1 ? 1.0 : 0.0), height, point.y + (corner == 2 ? 1.0 : 0.0));
		}
	}
	return steps_of([&] {
		TriangleTerrain terrain;
		need(terrain.set(corners));
		std::vector<Ground> ground(fixed_positions().size());
		need(terrain.sample(fixed_positions(), ground));
	});
}

std::uint64_t mesh_of_small(const Recipe &recipe, std::size_t count) { return mesh(recipe, count, false); }

std::uint64_t mesh_of_long(const Recipe &recipe, std::size_t count) { return mesh(recipe, count, true); }

constexpr std::array cases = {
		Case{"mesh: small triangles", mesh_of_small},
		Case{"mesh: long triangles", mesh_of_long},
};

} // namespace

std::span<const Case> cases_of_meshes() { return cases; }

} // namespace thicket::cost
