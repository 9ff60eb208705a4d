#pragma once

#include "core/base/status.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A surface of a mesh, in the byte format of Godot's renderer: first the positions, then all other
/// attributes.
struct MeshSurface {
	/// How vertices form triangles. Points and lines have the shape `none`.
	enum class Shape : std::uint8_t { none, triangles, strip };

	/// The storage format of positions. All formats are little-endian, like all platforms that
	/// Godot supports.
	enum class Positions : std::uint8_t {
		floats,    ///< Three 32-bit floats.
		flat,      ///< Two 32-bit floats; z is 0.
		quantized, ///< Four 16-bit numbers: x, y and z as fractions of the box, and an unrelated number.
	};

	Shape shape = Shape::none;
	Positions positions = Positions::floats;
	std::size_t vertex_count = 0;
	std::size_t index_count = 0;              ///< 0 if vertices are used in order.
	std::span<const std::uint8_t> vertices{}; ///< May be longer than the positions require.
	std::span<const std::uint8_t> indices{};  ///< Indices of two or four bytes each.
	glm::vec3 box_corner{0.0F};               ///< The minimum corner of the box of quantized positions.
	glm::vec3 box_size{0.0F};

	/// Returns three times the number of triangles. Returns 0 for surfaces that Godot's
	/// TriangleMesh skips: points and lines, strips of fewer than three vertices, and triangle
	/// lists whose vertex count is not a multiple of three. If a surface is indexed, its index
	/// count is used instead of its vertex count.
	std::size_t corner_count() const;
};

/// Appends three corners per triangle, in the surface's order. These are the faces of Godot's
/// TriangleMesh, without its rounding to 0.1 mm. Returns an error if there are too few bytes or if
/// an index does not refer to a vertex; the contents of `r_corners` are then unspecified.
Status append_faces(const MeshSurface &surface, std::vector<glm::vec3> &r_corners);

} // namespace thicket
