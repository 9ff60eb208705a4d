#pragma once

#include "core/base/status.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A surface of a mesh, in the bytes in which Godot's renderer stores it: positions first, then everything else.
struct MeshSurface {
	/// How vertices form triangles. Points and lines form none.
	enum class Shape : std::uint8_t { none, triangles, strip };

	/// How a position is stored. All formats are little-endian, like Godot's platforms.
	enum class Positions : std::uint8_t {
		floats,    ///< Three 32-bit floats.
		flat,      ///< Two 32-bit floats; z is 0.
		quantized, ///< Four 16-bit numbers: x, y and z as fractions of the box, and one unrelated to the position.
	};

	Shape shape = Shape::none;
	Positions positions = Positions::floats;
	std::size_t vertex_count = 0;
	std::size_t index_count = 0;              ///< 0: vertices are used in their order.
	std::span<const std::uint8_t> vertices{}; ///< May be longer than the positions.
	std::span<const std::uint8_t> indices{};  ///< Two bytes each if that suffices, otherwise four.
	glm::vec3 box_corner{0.0F};               ///< The lowest corner of the box of quantized positions.
	glm::vec3 box_size{0.0F};

	/// The number of corners of all triangles. 0 for surfaces that Godot's TriangleMesh also omits: those without triangles, those whose
	/// corners do not form whole triangles, and strips of fewer than three.
	std::size_t corner_count() const;
};

/// Appends three corners per triangle, in the surface's order: the faces of Godot's TriangleMesh without its rounding to 0.1 mm. Refuses
/// too few bytes, and indices of vertices that do not exist. `r_corners` is then unspecified.
Status append_faces(const MeshSurface &surface, std::vector<glm::vec3> &r_corners);

} // namespace thicket
