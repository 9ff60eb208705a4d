#pragma once

#include <godot_cpp/variant/vector3.hpp>

namespace godot {

/// An axis-aligned box: the minimum corner and the size.
struct AABB {
	Vector3 position;
	Vector3 size;

	AABB() = default;
	AABB(const Vector3 &p_position, const Vector3 &p_size) : position(p_position), size(p_size) {}

	bool operator==(const AABB &) const = default;
};

} // namespace godot
