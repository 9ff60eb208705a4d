#pragma once

#include <godot_cpp/core/defs.hpp>

namespace godot {

/// A color with red, green, blue and alpha components.
struct Color {
	float r = 0.0F;
	float g = 0.0F;
	float b = 0.0F;
	float a = 1.0F;

	Color() = default;
	Color(float p_r, float p_g, float p_b, float p_a = 1.0F) : r(p_r), g(p_g), b(p_b), a(p_a) {}

	bool operator==(const Color &) const = default;
};

} // namespace godot
