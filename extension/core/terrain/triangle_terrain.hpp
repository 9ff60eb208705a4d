#pragma once

#include "core/base/rect.hpp"
#include "core/base/bvh.hpp"
#include "core/base/lazy.hpp"
#include "core/terrain/box_tree.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The order of a triangle's corners, seen from its front. Corners of the engine's meshes are
/// clockwise, except those of mirrored instances.
enum class Winding : std::uint8_t { clockwise, counterclockwise };

/// The topmost surface of triangle meshes: at each position, the highest triangle is the ground.
/// Triangles that face down are ground, too; their normals are flipped upward. Vertical triangles
/// are only part of `surface_of`. Immutable after `set`.
class TriangleTerrain final : public Terrain {
public:
	/// Sets the triangles. `corners` has three world positions per triangle, in meters, with any
	/// winding. All must be finite and within max_extent of the origin on each axis, and there may
	/// be at most max_triangles triangles. The function builds a bounding volume hierarchy in O(n
	/// log n) time and O(n) memory, regardless of the sizes of the triangles. After `cancel` is
	/// set, it returns ErrorCode::cancelled within about 100 ms. A failed call leaves the object
	/// unchanged. `winding` matters only for `surface_of`.
	Status set(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel = nullptr,
			Winding winding = Winding::clockwise);

	/// Returns all triangles, including vertical ones but not those without an area. The first
	/// search builds a tree, on the thread that searches.
	static std::shared_ptr<const Surface> surface_of(std::shared_ptr<const TriangleTerrain> terrain);

	/// Returns the index of the first corner that `set` rejects, or the number of corners if there
	/// is none.
	static std::size_t find_refused_corner(std::span<const glm::dvec3> corners);

	/// See Terrain::sample(). A position on an edge or a corner belongs to all adjacent triangles.
	/// This test is exact (see orientation()), so a mesh without gaps produces ground without gaps.
	/// Among triangles of equal height, the first one in `corners` determines the normal. The
	/// height is exact up to float rounding.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The ground at a position, with its unrounded height in meters.
	struct Top {
		double height = 0.0;
		glm::vec3 normal{0.0f, 1.0f, 0.0f};
	};

	/// Finds the same ground as `sample`. Returns false if there is none, or if it is lower than
	/// `min_height` meters.
	bool find_top(glm::dvec2 position, double min_height, Top &r_top) const;

	/// Returns the bounding rectangle of all triangles that are not vertical, including its far
	/// edges. The rectangle is empty if there are no such triangles.
	const Rect &area() const { return area_; }

	/// Returns false if there are no triangles, or if all are vertical.
	bool has_ground() const { return !triangles_.empty(); }

	/// Returns the bounding box of all triangles, including vertical ones, or `no_box` if there are
	/// none.
	const Box3 &bounds() const { return bounds_; }

	/// Returns the height of the highest corner, in meters. The terrain must have ground.
	double top() const { return top_; }

	static constexpr double max_extent = 1e7;
	static constexpr std::size_t max_triangles = std::size_t{1} << 24;

private:
	struct Triangle {
		std::array<glm::dvec3, 3> corners;
		std::uint32_t index; ///< Index in the input of `set`.
	};

	/// Bounds of a node's triangles: their horizontal area, and their highest point.
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
		double top;

		/// Returns true if the position is inside or on the border, and false for NAN.
		bool contains(glm::dvec2 position) const {
			return position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
		}
	};

	/// The highest triangle found so far.
	struct Hit {
		const Triangle *triangle = nullptr;
		double height = 0.0;
	};

	static Box around(const Triangle &triangle);
	static Box around(const Box &a, const Box &b);
	static void meet(const Triangle &triangle, glm::dvec2 position, Hit &r_hit);
	static glm::vec3 normal_of(const Triangle &triangle);

	class AllTriangles;

	void take(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel);
	void build_boxes();

	Rect area_;
	double top_ = 0.0;
	std::vector<Triangle> triangles_; ///< The triangles, in tree order.
	Bvh tree_;
	std::vector<Box> boxes_; ///< Bounds of the nodes, by Bvh::index_of().
	std::vector<std::array<glm::dvec3, 3>> vertical_;
	Winding winding_ = Winding::clockwise;
	Box3 bounds_ = no_box;
	/// A search tree over all triangles in space.
	std::shared_ptr<const Lazy<BoxTree>> surface_tree_;
};

} // namespace thicket
