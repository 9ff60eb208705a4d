#pragma once

#include <godot_cpp/core/defs.hpp>

namespace godot {

/// A color with red, green, blue and alpha components.
struct Color {
	float r = 0.0F;
	float g = 0.0F;
	float b = 0.0F;
	float a = 1.0F;

	constexpr bool operator==(const Color &) const = default;
};

} // namespace godot
