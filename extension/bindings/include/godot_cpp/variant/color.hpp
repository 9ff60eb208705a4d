#pragma once

#include <godot_cpp/core/defs.hpp>

namespace godot {

/// Red, green, blue and alpha.
struct Color {
	float r = 0.0F;
	float g = 0.0F;
	float b = 0.0F;
	float a = 1.0F;

	constexpr bool operator==(const Color &) const = default;
};

} // namespace godot
