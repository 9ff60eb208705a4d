#include "nodes/model/body_part.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/box_shape3d.hpp>
#include <godot_cpp/classes/capsule_shape3d.hpp>
#include <godot_cpp/classes/convex_polygon_shape3d.hpp>
#include <godot_cpp/classes/cylinder_shape3d.hpp>
#include <godot_cpp/classes/sphere_shape3d.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

glm::vec3 round_size(double radius, double height) {
	return {static_cast<float>(2.0 * radius), static_cast<float>(height), static_cast<float>(2.0 * radius)};
}

/// Reads the kind, and the size or corners, of an untransformed shape. Returns false for an
/// unsupported shape.
bool measure(Shape3D *p_shape, BodyPart &r_part) {
	if (const auto *box = Object::cast_to<BoxShape3D>(p_shape)) {
		r_part.kind = BodyPart::Kind::box;
		r_part.size = glm::vec3(to_core(box->get_size()));
	} else if (const auto *sphere = Object::cast_to<SphereShape3D>(p_shape)) {
		r_part.kind = BodyPart::Kind::sphere;
		r_part.size = glm::vec3(static_cast<float>(2.0 * sphere->get_radius()));
	} else if (const auto *capsule = Object::cast_to<CapsuleShape3D>(p_shape)) {
		r_part.kind = BodyPart::Kind::capsule;
		r_part.size = round_size(capsule->get_radius(), capsule->get_height());
	} else if (const auto *cylinder = Object::cast_to<CylinderShape3D>(p_shape)) {
		r_part.kind = BodyPart::Kind::cylinder;
		r_part.size = round_size(cylinder->get_radius(), cylinder->get_height());
	} else if (const auto *convex = Object::cast_to<ConvexPolygonShape3D>(p_shape)) {
		r_part.kind = BodyPart::Kind::convex;
		const PackedVector3Array points = convex->get_points();
		for (const Vector3 &point : points) {
			r_part.corners.emplace_back(to_core(point));
		}
	} else {
		return false;
	}
	return true;
}

/// Applies a basis to a part whose origin is still 0.
void transform(const glm::mat3 &basis, BodyPart &r_part) {
	for (glm::vec3 &corner : r_part.corners) {
		corner = basis * corner;
	}
	if (r_part.kind == BodyPart::Kind::convex) {
		return;
	}
	const glm::mat3 axes = basis * r_part.rotation;
	r_part.size *= glm::vec3(glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2]));
	if (r_part.kind == BodyPart::Kind::sphere) {
		r_part.size = glm::vec3(std::max({r_part.size.x, r_part.size.y, r_part.size.z}));
	} else if (r_part.kind != BodyPart::Kind::box) {
		r_part.size.x = r_part.size.z = std::max(r_part.size.x, r_part.size.z);
	}
	// Keep the y axis, which is the long axis of round shapes, and make the others perpendicular to
	// it.
	const glm::vec3 y = glm::normalize(axes[1]);
	const glm::vec3 x = glm::normalize(axes[0] - y * glm::dot(axes[0], y));
	r_part.rotation = glm::mat3(x, y, glm::cross(x, y));
}

} // namespace

std::optional<BodyPart> body_part(const ModelShape &shape) {
	BodyPart part;
	if (!measure(shape.shape.ptr(), part)) {
		return std::nullopt;
	}
	const auto origin = glm::vec3(to_core(shape.transform.origin));
	transform(glm::mat3(to_core(shape.transform.basis)), part);
	if (part.kind == BodyPart::Kind::convex) {
		for (glm::vec3 &corner : part.corners) {
			corner += origin;
		}
	} else {
		part.origin = origin;
	}
	return part;
}

BodyPart scaled(const BodyPart &part, glm::vec3 scale) {
	BodyPart result = part;
	transform(glm::mat3(scale.x, 0.0f, 0.0f, 0.0f, scale.y, 0.0f, 0.0f, 0.0f, scale.z), result);
	result.origin = part.origin * scale;
	return result;
}

} // namespace thicket
