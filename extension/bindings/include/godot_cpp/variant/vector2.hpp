#pragma once

#include <godot_cpp/core/defs.hpp>

namespace godot {

/// A 2D vector of reals.
struct Vector2 {
	real_t x = 0;
	real_t y = 0;

	Vector2() = default;
	Vector2(real_t p_x, real_t p_y) : x(p_x), y(p_y) {}

	bool operator==(const Vector2 &) const = default;
};

} // namespace godot
