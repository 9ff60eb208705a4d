#pragma once

#include <godot_cpp/variant/basis.hpp>

namespace godot {

/// A basis followed by a translation.
struct Transform3D {
	Basis basis;
	Vector3 origin;

	Transform3D() = default;
	Transform3D(const Basis &p_basis, const Vector3 &p_origin = Vector3()) : basis(p_basis), origin(p_origin) {}

	bool operator==(const Transform3D &) const = default;
};

} // namespace godot
