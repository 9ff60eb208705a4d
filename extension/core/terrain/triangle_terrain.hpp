#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The tops of triangle meshes: from straight above, the first triangle is the ground. Triangles that face down count as
/// tops too if nothing lies above them, with their normal turned up; those on edge are left out. Immutable after `set`.
class TriangleTerrain final : public Terrain {
public:
	/// `corners` holds three world positions a triangle, in metres, in any winding; all finite and within max_extent of the
	/// origin, at most max_triangles. Refused ones change nothing. Builds a grid over the triangles: O(n) memory.
	Status set(std::span<const glm::dvec3> corners);

	/// As Terrain::sample. A place on an edge or a corner belongs to every triangle that meets there, so meshes without a
	/// gap give ground without one. The normal is that of the triangle, the height exact to a float's rounding.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The rectangle around all triangles; empty for none.
	const Rect &area() const { return area_; }

	static constexpr double max_extent = 1e7;
	static constexpr std::size_t max_triangles = std::size_t{1} << 24;

private:
	Ground ground_at(glm::dvec2 position) const;

	Rect area_;
	std::vector<glm::dvec3> corners_;
	std::vector<std::uint32_t> cell_begin_; ///< One more than cells; into cell_triangles_.
	std::vector<std::uint32_t> cell_triangles_;
	glm::ivec2 cells_{0};
	glm::dvec2 cells_per_metre_{0.0};
};

} // namespace thicket
