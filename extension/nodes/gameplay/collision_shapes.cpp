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

float side(double meters) { return std::clamp(static_cast<float>(meters), min_side, max_side); }

Dictionary round_shape(float radius, float height) {
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
	const auto [kind, number, width, height, depth] = key;
	Shape shape;
	switch (kind) {
		case BodyPart::Kind::capsule:
			shape.rid = server->capsule_shape_create();
			server->shape_set_data(shape.rid, round_shape(0.5F * width, height));
			break;
		case BodyPart::Kind::cylinder:
			shape.rid = server->cylinder_shape_create();
			server->shape_set_data(shape.rid, round_shape(0.5F * width, height));
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

const CollisionShapes::Corners *CollisionShapes::corners_of(const ShapeSource &source, std::uint32_t mesh) {
	if (mesh >= source.meshes.size() || source.meshes[mesh].is_null()) {
		return nullptr;
	}
	const Ref<Mesh> &of = source.meshes[mesh];
	Corners &corners = corners_[of->get_instance_id()];
	if (corners.number != 0 && corners.box == source.boxes[mesh]) {
		// The mesh is unchanged, so its hull is still valid.
		return usable(corners);
	}
	corners = {source.boxes[mesh], ++last_number_, convex_corners(of)};
	return usable(corners);
}

const CollisionShapes::Corners *CollisionShapes::corners_of(const BodyPart &part) {
	const auto found = std::ranges::find(part_corners_, part, &std::pair<BodyPart, Corners>::first);
	if (found != part_corners_.end()) {
		// Equal parts share their corners.
		return usable(found->second);
	}
	part_corners_.push_back({part, {AABB(), ++last_number_, part.corners}});
	Corners &corners = part_corners_.back().second;
	keep_outermost(corners.points, max_convex_corners);
	return usable(corners);
}

/// Returns `corners`, or null if there are too few to enclose a volume.
const CollisionShapes::Corners *CollisionShapes::usable(const Corners &corners) {
	return corners.points.size() >= min_corners ? &corners : nullptr;
}

CollisionShapes::Shape *CollisionShapes::take(const Key &key, const std::vector<glm::vec3> &corners) {
	const auto [found, fresh] = shapes_.try_emplace(key);
	if (fresh) {
		found->second = make(key, corners);
		found->second.key = &found->first;
	} else {
		// All bodies of this size share the shape.
		idle_ -= found->second.users == 0 ? 1 : 0;
	}
	++found->second.users;
	return &found->second;
}

void CollisionShapes::add_part(const BodyPart &part, const BodyFit &fit, std::vector<Placed> &r_shapes) {
	static const std::vector<glm::vec3> none;
	const glm::vec3 scale = fit.scale();
	if (part.kind == BodyPart::Kind::convex) {
		if (const Corners *corners = corners_of(part)) {
			r_shapes.push_back({take({part.kind, corners->number, scale.x, scale.y, scale.z}, corners->points)});
		}
		return;
	}
	const BodyPart placed_part = thicket::scaled(part, scale);
	const glm::vec3 size{side(placed_part.size.x), side(placed_part.size.y), side(placed_part.size.z)};
	// The height of a capsule is at least its diameter; at that height, it is a sphere.
	const float height = part.kind == BodyPart::Kind::capsule ? std::max(size.x, size.y) : size.y;
	r_shapes.push_back({take({part.kind, 0, size.x, height, size.z}, none), placed_part.rotation, placed_part.origin});
}

std::vector<CollisionShapes::Placed> CollisionShapes::take(
		const ShapeSource &source, std::uint32_t mesh, const BodyFit &fit) {
	std::vector<Placed> shapes;
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
			if (const Corners *corners = corners_of(source, mesh)) {
				const glm::vec3 scale = fit.scale();
				const Key key{BodyPart::Kind::convex, corners->number, scale.x, scale.y, scale.z};
				shapes.push_back({take(key, corners->points)});
			}
			return shapes;
		case ScatterLayer::COLLISION_MODEL:
			if (mesh < source.parts.size()) {
				for (const BodyPart &of : source.parts[mesh]) {
					add_part(of, fit, shapes);
				}
			}
			return shapes;
	}
	add_part(part, fit, shapes);
	return shapes;
}

void CollisionShapes::give_back(const std::vector<Placed> &shapes) {
	for (const Placed &placed : shapes) {
		Shape *shape = placed.shape;
		if (--shape->users > 0) {
			continue;
		}
		++idle_;
		if (!std::exchange(shape->listed, true)) {
			idle_list_.push_back(shape);
		}
	}
}

bool CollisionShapes::free_some() {
	int freed = 0;
	for (; freed < freed_at_once && idle_ > max_idle; ++freed) {
		Shape *shape = idle_list_.front();
		idle_list_.pop_front();
		shape->listed = false;
		if (shape->users == 0) {
			PhysicsServer3D::get_singleton()->free_rid(shape->rid);
			shapes_.erase(Key(*shape->key));
			--idle_;
		}
	}
	return freed > 0;
}

void CollisionShapes::clear() {
	for (const auto &[key, shape] : shapes_) {
		PhysicsServer3D::get_singleton()->free_rid(shape.rid);
	}
	shapes_.clear();
	idle_list_.clear();
	corners_.clear();
	part_corners_.clear();
	idle_ = 0;
}

} // namespace thicket
