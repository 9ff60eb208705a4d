#pragma once

#include <godot_cpp/variant/vector2.hpp>

namespace godot {

/// A rectangle: a corner, and the vector to the opposite corner.
struct Rect2 {
	Vector2 position;
	Vector2 size;

	Rect2() = default;
	Rect2(const Vector2 &p_position, const Vector2 &p_size) : position(p_position), size(p_size) {}
	Rect2(real_t p_x, real_t p_y, real_t p_width, real_t p_height) : position(p_x, p_y), size(p_width, p_height) {}

	bool operator==(const Rect2 &) const = default;
};

} // namespace godot
