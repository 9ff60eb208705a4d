#pragma once

#include "core/base/status.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A surface of a mesh in the bytes in which Godot's renderer stores it: positions first, then everything else.
struct MeshSurface {
	/// How vertices become triangles. Points and lines have none.
	enum class Shape : std::uint8_t { none, triangles, strip };

	/// How a position is stored. All are little-endian, as Godot's platforms are.
	enum class Positions : std::uint8_t {
		floats,    ///< Three 32-bit floats.
		flat,      ///< Two 32-bit floats; z is 0.
		quantized, ///< Four 16-bit numbers: x, y and z as parts of the box, and one that is no position.
	};

	Shape shape = Shape::none;
	Positions positions = Positions::floats;
	std::size_t vertex_count = 0;
	std::size_t index_count = 0;              ///< 0: the vertices are used in their order.
	std::span<const std::uint8_t> vertices{}; ///< May be longer than the positions.
	std::span<const std::uint8_t> indices{};  ///< Two bytes each if these suffice, else four.
	glm::vec3 box_corner{0.0F};               ///< The lowest corner of the box of quantized positions.
	glm::vec3 box_size{0.0F};

	/// The corners of all triangles; 0 for surfaces that Godot's TriangleMesh leaves out, too: without triangles, with a number of
	/// corners that makes no whole triangles, and strips of fewer than three.
	std::size_t corner_count() const;
};

/// Adds three corners a triangle, in the surface's order: the faces of Godot's TriangleMesh, but for its rounding to 0.1 mm.
/// Refuses too few bytes, and indices of vertices that do not exist; `r_corners` is unspecified then.
Status append_faces(const MeshSurface &surface, std::vector<glm::vec3> &r_corners);

} // namespace thicket
