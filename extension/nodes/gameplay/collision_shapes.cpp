#include "nodes/gameplay/collision_shapes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/model/convex_corners.hpp"

#include <godot_cpp/classes/physics_server3d.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The minimum number of points that can enclose a volume.
constexpr std::size_t min_corners = 4;

/// The range of shape dimensions that physics engines can handle, in meters.
constexpr float min_side = 1e-3F;
constexpr float max_side = 1e5F;

float clamped_side(double meters) { return std::clamp(static_cast<float>(meters), min_side, max_side); }

Dictionary round_shape_data(float radius, float height) {
	Dictionary data;
	data["radius"] = radius;
	data["height"] = height;
	return data;
}

PackedVector3Array scaled(const std::vector<glm::vec3> &points, glm::vec3 scale) {
	return packed<PackedVector3Array>(
			std::span(points), [scale](const glm::vec3 &point) { return to_engine(point * scale); });
}

} // namespace

CollisionShapes::Shape CollisionShapes::make(const Key &key, const std::vector<glm::vec3> &corners) {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	const auto [kind, corners_id, width, height, depth] = key;
	Shape shape;
	switch (kind) {
		case BodyPart::Kind::capsule:
			shape.rid = server->capsule_shape_create();
			server->shape_set_data(shape.rid, round_shape_data(0.5F * width, height));
			break;
		case BodyPart::Kind::cylinder:
			shape.rid = server->cylinder_shape_create();
			server->shape_set_data(shape.rid, round_shape_data(0.5F * width, height));
			break;
		case BodyPart::Kind::sphere:
			shape.rid = server->sphere_shape_create();
			server->shape_set_data(shape.rid, 0.5F * width);
			break;
		case BodyPart::Kind::box:
			shape.rid = server->box_shape_create();
			server->shape_set_data(shape.rid, Vector3(0.5F * width, 0.5F * height, 0.5F * depth));
			break;
		case BodyPart::Kind::convex:
			shape.rid = server->convex_polygon_shape_create();
			server->shape_set_data(shape.rid, scaled(corners, {width, height, depth}));
			break;
	}
	return shape;
}

const CollisionShapes::Corners *CollisionShapes::corners_of(const ShapeSource &source, std::uint32_t mesh_index) {
	if (mesh_index >= source.meshes.size() || source.meshes[mesh_index].is_null()) {
		return nullptr;
	}
	const Ref<Mesh> &mesh = source.meshes[mesh_index];
	Corners &corners = corners_[mesh->get_instance_id()];
	if (corners.id != 0 && corners.box == source.boxes[mesh_index]) {
		// The mesh is unchanged, so its hull is still valid.
		return usable_corners(corners);
	}
	corners = {source.boxes[mesh_index], ++last_corners_id_, convex_corners(mesh)};
	return usable_corners(corners);
}

const CollisionShapes::Corners *CollisionShapes::corners_of(const BodyPart &part) {
	const auto entry = std::ranges::find(part_corners_, part, &std::pair<BodyPart, Corners>::first);
	if (entry != part_corners_.end()) {
		// Equal parts share their corners.
		return usable_corners(entry->second);
	}
	part_corners_.push_back({part, {AABB(), ++last_corners_id_, part.corners}});
	Corners &corners = part_corners_.back().second;
	keep_outermost(corners.points, max_convex_corners);
	return usable_corners(corners);
}

/// Returns `corners`, or null if there are too few to enclose a volume.
const CollisionShapes::Corners *CollisionShapes::usable_corners(const Corners &corners) {
	return corners.points.size() >= min_corners ? &corners : nullptr;
}

CollisionShapes::Shape *CollisionShapes::take(const Key &key, const std::vector<glm::vec3> &corners) {
	const auto [entry, is_new] = shapes_.try_emplace(key);
	if (is_new) {
		entry->second = make(key, corners);
		entry->second.key = &entry->first;
	} else {
		// All bodies of this size share the shape.
		idle_count_ -= entry->second.users == 0 ? 1 : 0;
	}
	++entry->second.users;
	return &entry->second;
}

void CollisionShapes::add_part(const BodyPart &part, const BodyFit &fit, std::vector<PlacedShape> &r_shapes) {
	static const std::vector<glm::vec3> no_corners;
	const glm::vec3 scale = fit.scale();
	if (part.kind == BodyPart::Kind::convex) {
		if (const Corners *corners = corners_of(part)) {
			r_shapes.push_back({take({part.kind, corners->id, scale.x, scale.y, scale.z}, corners->points)});
		}
		return;
	}
	const BodyPart placed_part = thicket::scaled(part, scale);
	const glm::vec3 size{
			clamped_side(placed_part.size.x), clamped_side(placed_part.size.y), clamped_side(placed_part.size.z)};
	// The height of a capsule is at least its diameter; at that height, it is a sphere.
	const float height = part.kind == BodyPart::Kind::capsule ? std::max(size.x, size.y) : size.y;
	r_shapes.push_back(
			{take({part.kind, 0, size.x, height, size.z}, no_corners), placed_part.rotation, placed_part.origin});
}

std::vector<CollisionShapes::PlacedShape> CollisionShapes::take(
		const ShapeSource &source, std::uint32_t mesh_index, const BodyFit &fit) {
	std::vector<PlacedShape> shapes;
	const InstanceShape &cylinder = source.cylinder;
	BodyPart part;
	part.size = glm::vec3(2.0 * cylinder.radius, cylinder.height, 2.0 * cylinder.radius);
	part.origin.y = 0.5F * part.size.y;
	switch (source.kind) {
		case ScatterLayer::COLLISION_NONE: return shapes;
		case ScatterLayer::COLLISION_CAPSULE: part.kind = BodyPart::Kind::capsule; break;
		case ScatterLayer::COLLISION_CYLINDER: part.kind = BodyPart::Kind::cylinder; break;
		case ScatterLayer::COLLISION_BOX: part.kind = BodyPart::Kind::box; break;
		case ScatterLayer::COLLISION_CONVEX:
			if (const Corners *corners = corners_of(source, mesh_index)) {
				const glm::vec3 scale = fit.scale();
				const Key key{BodyPart::Kind::convex, corners->id, scale.x, scale.y, scale.z};
				shapes.push_back({take(key, corners->points)});
			}
			return shapes;
		case ScatterLayer::COLLISION_MODEL:
			if (mesh_index < source.parts.size()) {
				for (const BodyPart &model_part : source.parts[mesh_index]) {
					add_part(model_part, fit, shapes);
				}
			}
			return shapes;
	}
	add_part(part, fit, shapes);
	return shapes;
}

void CollisionShapes::give_back(const std::vector<PlacedShape> &shapes) {
	for (const PlacedShape &placed : shapes) {
		Shape *shape = placed.shape;
		if (--shape->users > 0) {
			continue;
		}
		++idle_count_;
		if (!std::exchange(shape->is_listed, true)) {
			idle_list_.push_back(shape);
		}
	}
}

bool CollisionShapes::free_some() {
	int freed_count = 0;
	for (; freed_count < max_freed_per_call && idle_count_ > max_idle; ++freed_count) {
		Shape *shape = idle_list_.front();
		idle_list_.pop_front();
		shape->is_listed = false;
		if (shape->users == 0) {
			PhysicsServer3D::get_singleton()->free_rid(shape->rid);
			shapes_.erase(Key(*shape->key));
			--idle_count_;
		}
	}
	return freed_count > 0;
}

void CollisionShapes::clear() {
	for (const auto &[key, shape] : shapes_) {
		PhysicsServer3D::get_singleton()->free_rid(shape.rid);
	}
	shapes_.clear();
	idle_list_.clear();
	corners_.clear();
	part_corners_.clear();
	idle_count_ = 0;
}

} // namespace thicket
