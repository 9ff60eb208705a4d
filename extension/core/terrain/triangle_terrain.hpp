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

/// The tops of triangle meshes: seen from straight above, the first triangle is the ground. Triangles that face down also count as tops
/// if no triangle is above them; their normal is then flipped upwards. Vertical triangles are ignored. Immutable after `set`.
class TriangleTerrain final : public Terrain {
public:
	/// `corners` has three world positions per triangle, in meters, in any winding, all finite and within max_extent of the origin on
	/// each axis. There may be at most max_triangles. Refused input changes nothing. Builds a tree of boxes over the triangles: O(n log
	/// n) time, O(n) memory, whatever their sizes. Returns ErrorCode::cancelled within about 100 ms of raising `cancel`, and changes
	/// nothing.
	Status set(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel = nullptr);

	/// The first corner that `set` refuses for its position, or the number of corners if there is none.
	static std::size_t find_refused_corner(std::span<const glm::dvec3> corners);

	/// See Terrain::sample. A position on an edge or a corner belongs to every triangle that meets there (exactly: see orientation), so
	/// meshes without gaps give ground without gaps. The normal is that of the triangle, or of the first in `corners` among equally high
	/// ones. The height is exact up to float rounding.
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override;

	/// The ground at one position, with its unrounded height.
	struct Top {
		double height = 0.0;
		glm::vec3 normal{0.0f, 1.0f, 0.0f};
	};

	/// Returns false if the ground at the position is below `least` meters or missing. Otherwise finds exactly the same
	/// ground as `sample`.
	bool find_top(glm::dvec2 position, double least, Top &r_top) const;

	/// The rectangle around all triangles that are not vertical, from corner to corner. Empty if there are none. Its far borders have
	/// ground.
	const Rect &area() const { return area_; }

	/// False if there are no triangles, or all are vertical.
	bool has_ground() const { return !triangles_.empty(); }

	/// The height of the highest corner, in meters. Requires ground.
	double top() const { return top_; }

	static constexpr double max_extent = 1e7;
	static constexpr std::size_t max_triangles = std::size_t{1} << 24;

private:
	struct Triangle {
		std::array<glm::dvec3, 3> corners;
		std::uint32_t index; ///< Index in the input of `set`.
	};

	/// Bounds of a node's triangles: their area seen from above, and their highest point.
	struct Box {
		glm::dvec2 min;
		glm::dvec2 max;
		double top;

		/// Borders included. False for NAN.
		bool holds(glm::dvec2 position) const {
			return position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
		}
	};

	/// The topmost triangle until now.
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
	std::vector<Triangle> triangles_; ///< In tree order.
	Bvh tree_;
	std::vector<Box> boxes_; ///< Indexed by the tree's slots.
};

} // namespace thicket
