#pragma once

namespace godot {

/// Red, green, blue and alpha, 0 to 1.
struct Color {
	float r = 0;
	float g = 0;
	float b = 0;
	float a = 1;

	constexpr Color() = default;
	constexpr Color(float p_r, float p_g, float p_b, float p_a = 1) :
			r(p_r), g(p_g), b(p_b), a(p_a) {}
};

} // namespace godot
