#pragma once

#include <godot_cpp/core/defs.hpp>

#include <algorithm>
#include <cmath>

namespace godot {

/// A 3D vector of reals.
struct Vector3 {
	real_t x = 0;
	real_t y = 0;
	real_t z = 0;

	Vector3() = default;
	Vector3(real_t p_x, real_t p_y, real_t p_z) : x(p_x), y(p_y), z(p_z) {}

	bool operator==(const Vector3 &) const = default;

	const real_t &operator[](int p_axis) const { return p_axis == 0 ? x : p_axis == 1 ? y : z; }
	real_t &operator[](int p_axis) { return p_axis == 0 ? x : p_axis == 1 ? y : z; }

	real_t length() const { return std::sqrt(x * x + y * y + z * z); }
	Vector3 abs() const { return Vector3(std::abs(x), std::abs(y), std::abs(z)); }
	Vector3 max(const Vector3 &p_other) const {
		return Vector3(std::max(x, p_other.x), std::max(y, p_other.y), std::max(z, p_other.z));
	}
	Vector3 operator+(const Vector3 &p_other) const { return Vector3(x + p_other.x, y + p_other.y, z + p_other.z); }
	Vector3 operator-(const Vector3 &p_other) const { return Vector3(x - p_other.x, y - p_other.y, z - p_other.z); }
};

} // namespace godot
