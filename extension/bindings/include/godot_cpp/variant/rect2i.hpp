#pragma once

#include <godot_cpp/variant/vector2i.hpp>

namespace godot {

/// A rectangle with integer coordinates: a corner, and the vector to the opposite corner.
struct Rect2i {
	Vector2i position;
	Vector2i size;

	Rect2i() = default;
	Rect2i(const Vector2i &p_position, const Vector2i &p_size) : position(p_position), size(p_size) {}

	bool operator==(const Rect2i &) const = default;
};

} // namespace godot
