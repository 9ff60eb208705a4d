#pragma once

#include <godot_cpp/core/defs.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace godot {

/// A 3D vector of reals. GLM provides the arithmetic.
struct Vector3 : glm::vec<3, real_t> {
	constexpr Vector3() : vec(real_t(0)) {}
	constexpr Vector3(real_t p_x, real_t p_y, real_t p_z) : vec(p_x, p_y, p_z) {}
	constexpr Vector3(const vec &p_from) : vec(p_from) {}

	real_t length() const { return glm::length<3, real_t>(*this); }
	Vector3 abs() const { return glm::abs<3, real_t>(*this); }
	Vector3 max(const Vector3 &p_other) const { return glm::max<3, real_t>(*this, p_other); }

	friend Vector3 operator+(const Vector3 &p_a, const Vector3 &p_b) {
		return static_cast<vec>(p_a) + static_cast<vec>(p_b);
	}
};

} // namespace godot
