#pragma once

#include "core/base/rect.hpp"
#include "core/base/bvh.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The tops of triangle meshes: from straight above, the first triangle is the ground. Triangles that face down count as
/// tops too if nothing lies above them, with their normal turned up; those on edge are left out. Immutable after `set`.
class TriangleTerrain final : public Terrain {
public:
	/// `corners` holds three world positions a triangle, in meters, in any winding; all finite and within max_extent of the
	/// origin on each axis, at most max_triangles. Refused ones change nothing. Builds a tree of boxes over the triangles: O(n
	/// log n) time, O(n) memory, whatever their sizes. Within some 100 ms of raising `cancel` it returns ErrorCode::cancelled and
	/// changes nothing.
	Status set(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel = nullptr);

	/// The first corner that `set` refuses for where it is; the number of corners if there is none.
	static std::size_t find_refused_corner(std::span<const glm::dvec3> corners);

	/// As Terrain::sample. A position on an edge or a corner belongs to every triangle that meets there (exactly: see
	/// orientation), so meshes without a gap give ground without one. The normal is that of the triangle, of equally high ones
	/// the first in `corners`; the height is exact to a float's rounding.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The ground at one position, with its height before it is rounded.
	struct Top {
		double height = 0.0;
		glm::vec3 normal{0.0f, 1.0f, 0.0f};
	};

	/// False if there is no ground, or none at `least` meters or above. Exactly what `sample` finds otherwise.
	bool find_top(glm::dvec2 position, double least, Top &r_top) const;

	/// The rectangle around all triangles but those on edge, from corner to corner; empty for none. Its far borders have ground.
	const Rect &area() const { return area_; }

	/// False if all triangles are on edge, or there are none.
	bool has_ground() const { return !triangles_.empty(); }

	/// The height of the highest corner, in meters. Not without ground.
	double top() const { return top_; }

	static constexpr double max_extent = 1e7;
	static constexpr std::size_t max_triangles = std::size_t{1} << 24;

private:
	struct Triangle {
		std::array<glm::dvec3, 3> corners;
		std::uint32_t index; ///< In what `set` was given.
	};

	/// Around the triangles of a node, seen from above, and how high they reach.
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
		double top;

		/// Borders included; false for NAN.
		bool holds(glm::dvec2 position) const {
			return position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
		}
	};

	/// The topmost triangle found so far.
	struct Hit {
		const Triangle *triangle = nullptr;
		double height = 0.0;
	};

	static Box around(const Triangle &triangle);
	static Box around(const Box &a, const Box &b);
	static void meet(const Triangle &triangle, glm::dvec2 position, Hit &r_hit);
	static glm::vec3 normal_of(const Triangle &triangle);

	void take(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel);
	void build_boxes();

	Rect area_;
	double top_ = 0.0;
	std::vector<Triangle> triangles_; ///< In the order of the tree.
	Bvh tree_;
	std::vector<Box> boxes_; ///< By the tree's slots.
};

} // namespace thicket
