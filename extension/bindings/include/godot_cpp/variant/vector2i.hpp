#pragma once

#include <cstdint>

namespace godot {

/// A 2D vector of 32-bit integers.
struct Vector2i {
	int32_t x = 0;
	int32_t y = 0;

	Vector2i() = default;
	Vector2i(int32_t p_x, int32_t p_y) : x(p_x), y(p_y) {}

	bool operator==(const Vector2i &) const = default;
};

} // namespace godot
