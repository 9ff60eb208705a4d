#pragma once

#include <godot_cpp/core/defs.hpp>

#include <glm/vec2.hpp>

namespace godot {

/// A 2D vector of reals. GLM provides the arithmetic.
struct Vector2 : glm::vec<2, real_t> {
	constexpr Vector2() : vec(real_t(0)) {}
	constexpr Vector2(real_t p_x, real_t p_y) : vec(p_x, p_y) {}
	constexpr Vector2(const vec &p_from) : vec(p_from) {}
};

} // namespace godot
