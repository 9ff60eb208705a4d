#include "nodes/gameplay/collision_shapes.hpp"

#include <godot_cpp/classes/convex_polygon_shape3d.hpp>
#include <godot_cpp/classes/physics_server3d.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

/// Fewer points than this span no body.
constexpr std::size_t min_corners = 4;

/// Sides of a shape in meters: what engines of physics can work with.
constexpr float min_side = 1e-3F;
constexpr float max_side = 1e5F;

float side(double meters) { return std::clamp(static_cast<float>(meters), min_side, max_side); }

Dictionary round_shape(float radius, float height) {
	Dictionary data;
	data["radius"] = radius;
	data["height"] = height;
	return data;
}

PackedVector3Array scaled(const std::vector<glm::vec3> &points, glm::vec3 scale) {
	PackedVector3Array result;
	result.resize(static_cast<int64_t>(points.size()));
	Vector3 *out = result.ptrw();
	for (const glm::vec3 &point : points) {
		*out++ = Vector3(point.x * scale.x, point.y * scale.y, point.z * scale.z);
	}
	return result;
}

} // namespace

CollisionShapes::Key CollisionShapes::key_of(const ShapeSource &source, const BodyFit &fit, std::uint64_t corners) {
	const glm::vec3 scale = fit.scale();
	if (source.kind == ScatterLayer::COLLISION_CONVEX) {
		return {source.kind, corners, scale.x, scale.y, scale.z};
	}
	const float width = side(2.0 * source.cylinder.radius * scale.x);
	const float height = side(source.cylinder.height * scale.y);
	const float depth = side(2.0 * source.cylinder.radius * std::abs(scale.z));
	if (source.kind == ScatterLayer::COLLISION_BOX) {
		return {source.kind, 0, width, height, depth};
	}
	const float radius = 0.5F * std::max(width, depth);
	const bool capsule = source.kind == ScatterLayer::COLLISION_CAPSULE;
	return {source.kind, 0, radius, capsule ? std::max(height, 2.0F * radius) : height, 0.0F};
}

CollisionShapes::Shape CollisionShapes::make(const Key &key, const std::vector<glm::vec3> &corners) {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	const auto [kind, number, a, b, c] = key;
	Shape shape;
	shape.center = kind == ScatterLayer::COLLISION_CONVEX ? 0.0 : 0.5 * static_cast<double>(b);
	switch (kind) {
		case ScatterLayer::COLLISION_CAPSULE:
			shape.rid = server->capsule_shape_create();
			server->shape_set_data(shape.rid, round_shape(a, b));
			break;
		case ScatterLayer::COLLISION_CYLINDER:
			shape.rid = server->cylinder_shape_create();
			server->shape_set_data(shape.rid, round_shape(a, b));
			break;
		case ScatterLayer::COLLISION_BOX:
			shape.rid = server->box_shape_create();
			server->shape_set_data(shape.rid, Vector3(0.5F * a, 0.5F * b, 0.5F * c));
			break;
		default:
			shape.rid = server->convex_polygon_shape_create();
			server->shape_set_data(shape.rid, scaled(corners, {a, b, c}));
			break;
	}
	return shape;
}

const CollisionShapes::Corners *CollisionShapes::corners_of(const ShapeSource &source, std::uint32_t mesh) {
	if (mesh >= source.meshes.size() || source.meshes[mesh].is_null()) {
		return nullptr;
	}
	const Ref<Mesh> &of = source.meshes[mesh];
	Corners &corners = corners_[of->get_instance_id()];
	if (corners.number == 0 || !(corners.box == source.boxes[mesh])) {
		corners = {source.boxes[mesh], ++last_number_, {}};
		const Ref<ConvexPolygonShape3D> hull = of->create_convex_shape(true, false);
		const PackedVector3Array points = hull.is_valid() ? hull->get_points() : PackedVector3Array();
		for (const Vector3 &point : points) {
			corners.points.emplace_back(point.x, point.y, point.z);
		}
		keep_outermost(corners.points, max_corners);
	}
	return corners.points.size() >= min_corners ? &corners : nullptr;
}

CollisionShapes::Shape *CollisionShapes::take(const ShapeSource &source, std::uint32_t mesh, const BodyFit &fit) {
	static const std::vector<glm::vec3> none;
	const bool convex = source.kind == ScatterLayer::COLLISION_CONVEX;
	const Corners *corners = convex ? corners_of(source, mesh) : nullptr;
	if (source.kind == ScatterLayer::COLLISION_NONE || (convex && corners == nullptr)) {
		return nullptr;
	}
	const Key key = key_of(source, fit, convex ? corners->number : 0);
	const auto [found, fresh] = shapes_.try_emplace(key);
	if (fresh) {
		found->second = make(key, convex ? corners->points : none);
	} else if (found->second.users == 0) {
		--idle_;
	}
	++found->second.users;
	return &found->second;
}

void CollisionShapes::give_back(Shape *shape) {
	if (--shape->users == 0 && ++idle_ > max_idle) {
		free_idle();
	}
}

void CollisionShapes::free_idle() {
	std::erase_if(shapes_, [](const auto &entry) {
		const bool idle = entry.second.users == 0;
		if (idle) {
			PhysicsServer3D::get_singleton()->free_rid(entry.second.rid);
		}
		return idle;
	});
	idle_ = 0;
}

void CollisionShapes::clear() {
	for (const auto &[key, shape] : shapes_) {
		PhysicsServer3D::get_singleton()->free_rid(shape.rid);
	}
	shapes_.clear();
	corners_.clear();
	idle_ = 0;
}

} // namespace thicket
