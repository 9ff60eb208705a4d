#pragma once

#include <godot_cpp/core/defs.hpp>

#include <glm/vec2.hpp>

namespace godot {

/// A 2D vector of 32-bit integers. GLM provides the arithmetic.
struct Vector2i : glm::vec<2, int32_t> {
	constexpr Vector2i() : vec(0) {}
	constexpr Vector2i(int32_t p_x, int32_t p_y) : vec(p_x, p_y) {}
	constexpr Vector2i(const vec &p_from) : vec(p_from) {}
};

} // namespace godot
