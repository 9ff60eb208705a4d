#pragma once

#include <godot_cpp/variant/vector3.hpp>

namespace godot {

/// A 3 x 3 matrix for rotation and scale, stored in rows.
struct Basis {
	Vector3 rows[3] = {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};

	Basis() = default;
	/// Creates a basis from its columns: the directions of the axes.
	Basis(const Vector3 &p_x, const Vector3 &p_y, const Vector3 &p_z) :
			rows{Vector3(p_x.x, p_y.x, p_z.x), Vector3(p_x.y, p_y.y, p_z.y), Vector3(p_x.z, p_y.z, p_z.z)} {}

	bool operator==(const Basis &) const = default;
};

} // namespace godot
