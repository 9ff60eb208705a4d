#include "nodes/ground/collider_shapes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <godot_cpp/classes/box_shape3d.hpp>
#include <godot_cpp/classes/capsule_shape3d.hpp>
#include <godot_cpp/classes/concave_polygon_shape3d.hpp>
#include <godot_cpp/classes/convex_polygon_shape3d.hpp>
#include <godot_cpp/classes/cylinder_shape3d.hpp>
#include <godot_cpp/classes/height_map_shape3d.hpp>
#include <godot_cpp/classes/sphere_shape3d.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <span>

using namespace godot;

namespace thicket {

namespace {

AABB upright_box(real_t radius, real_t height) {
	return {{-radius, real_t(-0.5) * height, -radius}, {2 * radius, height, 2 * radius}};
}

std::optional<AABB> bounds_of_points(std::span<const Vector3> points) {
	if (points.empty()) {
		return std::nullopt;
	}
	Vector3 min = points.front();
	Vector3 max = min;
	for (const Vector3 &point : points) {
		min = {std::min(min.x, point.x), std::min(min.y, point.y), std::min(min.z, point.z)};
		max = {std::max(max.x, point.x), std::max(max.y, point.y), std::max(max.z, point.z)};
	}
	return AABB(min, max - min);
}

std::optional<AABB> bounds_of_array(const PackedVector3Array &points, std::size_t &r_points) {
	r_points += static_cast<std::size_t>(points.size());
	return bounds_of_points({points.ptr(), static_cast<std::size_t>(points.size())});
}

/// Returns the bounds of a heightmap shape. Its height samples are one meter apart and centered on
/// the origin.
std::optional<AABB> bounds_of_map(const HeightMapShape3D &map, std::size_t &r_points) {
	const PackedFloat32Array heights = map.get_map_data();
	const std::span<const float> posts(heights.ptr(), static_cast<std::size_t>(heights.size()));
	r_points += posts.size();
	float low = 0.0F;
	float high = 0.0F;
	for (const float height : posts) {
		low = std::min(low, height);
		high = std::max(high, height);
	}
	const auto width = static_cast<real_t>(map.get_map_width() - 1);
	const auto depth = static_cast<real_t>(map.get_map_depth() - 1);
	return AABB({real_t(-0.5) * width, low, real_t(-0.5) * depth}, {width, high - low, depth});
}

} // namespace

std::optional<AABB> bounds_of(const Ref<Shape3D> &p_shape, std::size_t &r_points) {
	const Object *shape = p_shape.ptr();
	if (const auto *box = Object::cast_to<BoxShape3D>(shape)) {
		const Vector3 size = box->get_size();
		return AABB({real_t(-0.5) * size.x, real_t(-0.5) * size.y, real_t(-0.5) * size.z}, size);
	}
	if (const auto *sphere = Object::cast_to<SphereShape3D>(shape)) {
		return upright_box(sphere->get_radius(), 2 * sphere->get_radius());
	}
	if (const auto *capsule = Object::cast_to<CapsuleShape3D>(shape)) {
		return upright_box(capsule->get_radius(), capsule->get_height());
	}
	if (const auto *cylinder = Object::cast_to<CylinderShape3D>(shape)) {
		return upright_box(cylinder->get_radius(), cylinder->get_height());
	}
	if (const auto *hull = Object::cast_to<ConvexPolygonShape3D>(shape)) {
		return bounds_of_array(hull->get_points(), r_points);
	}
	if (const auto *mesh = Object::cast_to<ConcavePolygonShape3D>(shape)) {
		return bounds_of_array(mesh->get_faces(), r_points);
	}
	const auto *map = Object::cast_to<HeightMapShape3D>(shape);
	return map != nullptr ? bounds_of_map(*map, r_points) : std::nullopt;
}

Rect area_of(const AABB &bounds, const Transform3D &frame) {
	const glm::dmat3 basis = to_core(frame.basis);
	const glm::dvec3 origin = to_core(frame.origin);
	const glm::dvec3 min_corner = to_core(bounds.position);
	const glm::dvec3 size = to_core(bounds.size);
	Rect area;
	for (int corner = 0; corner < 8; ++corner) {
		const glm::dvec3 fraction{corner & 1 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 4 ? 1.0 : 0.0};
		const glm::dvec3 position = origin + basis * (min_corner + fraction * size);
		const Rect point{{position.x, position.z}, {position.x, position.z}};
		area = corner == 0 ? point : united(area, point);
	}
	return area;
}

bool belongs_to_scatter(const Node *p_node) {
	for (const Node *node = p_node; node != nullptr; node = node->get_parent()) {
		const Node *parent = node->get_parent();
		// Scenes of instances are internal children of the TerrainScatter3D, after all other children.
		if (parent != nullptr && parent->is_class("TerrainScatter3D") &&
				node->get_index(true) >= parent->get_child_count(false)) {
			return true;
		}
	}
	return false;
}

} // namespace thicket
