#pragma once

#include <godot_cpp/variant/vector3.hpp>

namespace godot {

/// A 3 x 3 matrix for rotation and scale, stored in rows.
struct Basis {
	Vector3 rows[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

	constexpr Basis() = default;
	/// Creates a basis from its columns: the directions of the axes.
	constexpr Basis(const Vector3 &p_x, const Vector3 &p_y, const Vector3 &p_z) :
			rows{{p_x.x, p_y.x, p_z.x}, {p_x.y, p_y.y, p_z.y}, {p_x.z, p_y.z, p_z.z}} {}

	constexpr bool operator==(const Basis &) const = default;
};

} // namespace godot
