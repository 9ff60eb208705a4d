#include "nodes/gameplay/collision_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/physics_server3d.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Bodies in a frame: a microsecond or two each.
constexpr int most_freed = 16;

} // namespace

CollisionLayer collision_of(const LayerSnapshot *layer) {
	CollisionLayer result;
	if (layer == nullptr || layer->gameplay.collision.shape == BodyShape::none) {
		return result;
	}
	const LayerCollision &collision = layer->gameplay.collision;
	result.shape.kind = static_cast<ScatterLayer::CollisionShape>(collision.shape);
	result.shape.cylinder = {layer->gameplay.instance_radius, layer->gameplay.instance_height};
	if (collision.shape == BodyShape::convex) {
		result.shape.meshes = layer->drawing.meshes;
		result.shape.boxes = layer->drawing.boxes;
	}
	result.shape.parts = collision.parts;
	result.distance = collision.distance;
	result.settings = {collision.layer, collision.mask, collision.friction, collision.bounce};
	return result;
}

void CollisionRing::set_space(const RID &space, std::uint64_t node_id) {
	if (!(space_ == space) || node_id_ != node_id) {
		clear();
		space_ = space;
		node_id_ = node_id;
	}
}

void CollisionRing::set_layers(std::vector<CollisionLayer> layers) {
	for (std::uint32_t layer = static_cast<std::uint32_t>(layers.size()); layer < layers_.size(); ++layer) {
		fall_all(layer);
	}
	layers_.resize(layers.size());
	std::vector<double> distances;
	for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
		CollisionLayer &is = layers_[layer].is;
		CollisionLayer &next = layers[layer];
		distances.push_back(next.shape.kind == ScatterLayer::COLLISION_NONE ? 0.0 : next.distance);
		is.distance = next.distance;
		if (!(is.settings == next.settings)) {
			is.settings = next.settings;
			for (const auto &[id, body] : layers_[layer].bodies) {
				if (body.rid.is_valid()) {
					apply(is.settings, body.rid);
				}
			}
		}
		if (!(is.shape == next.shape)) {
			reshape(layer, std::move(next.shape));
		}
	}
	queue_.set_distances(distances);
}

void CollisionRing::reshape(std::uint32_t layer, ShapeSource source) {
	Layer &of = layers_[layer];
	of.is.shape = std::move(source);
	std::vector<PlacedInstance> standing;
	for (const auto &[id, body] : of.bodies) {
		standing.push_back(body.instance);
	}
	for (const PlacedInstance &instance : standing) {
		fall(layer, instance.id);
		stand(instance);
	}
}

void CollisionRing::look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	if (space_.is_valid()) {
		++frame_;
		tidy_pool();
		queue_.look_around(centers, world);
		for (Leaving gone; queue_.next_gone(gone);) {
			fall(gone.layer, gone.id);
		}
	}
}

bool CollisionRing::step() {
	Leaving leaving;
	const bool left = queue_.next_leaving(leaving);
	if (left) {
		fall(leaving.layer, leaving.id);
	}
	PlacedInstance instance;
	const bool entered = queue_.next_entering(instance);
	if (entered) {
		stand(instance);
	}
	return left || entered;
}

void CollisionRing::stand(const PlacedInstance &instance) {
	Layer &layer = layers_[instance.layer];
	Body &body = layer.bodies[instance.id];
	body.instance = instance;
	if (BodyFit fit; fit_body(instance.basis, fit)) {
		body.rotation = fit.rotation;
		body.shapes = shapes_.take(layer.is.shape, instance.mesh, fit);
	}
	if (body.shapes.empty()) {
		return;
	}
	body.rid = take_body();
	apply(layer.is.settings, body.rid);
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	for (const CollisionShapes::Placed &placed : body.shapes) {
		server->body_add_shape(body.rid, placed.shape->rid, to_engine(placed.rotation, placed.origin, glm::dvec3(0.0)));
	}
	server->body_set_state(body.rid, PhysicsServer3D::BODY_STATE_TRANSFORM, transform_of(body));
	server->body_set_space(body.rid, space_);
	owners_[body.rid.get_id()] = instance.id;
}

void CollisionRing::fall(std::uint32_t layer, std::uint64_t id) {
	auto &bodies = layers_[layer].bodies;
	const auto found = bodies.find(id);
	if (found == bodies.end()) {
		return;
	}
	const Body body = std::move(found->second);
	bodies.erase(found);
	if (body.rid.is_valid()) {
		PhysicsServer3D::get_singleton()->body_clear_shapes(body.rid);
		pool_.push_back({body.rid, frame_ + rest_frames});
		++still_in_space_;
		shapes_.give_back(body.shapes);
	}
}

void CollisionRing::fall_all(std::uint32_t layer) {
	while (!layers_[layer].bodies.empty()) {
		fall(layer, layers_[layer].bodies.begin()->first);
	}
	queue_.release_layer(layer);
}

void CollisionRing::drop(std::uint64_t id) {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		fall(layer, id);
	}
	queue_.release(id);
}

void CollisionRing::drop_if(const std::function<bool(std::uint64_t id)> &gone) {
	std::vector<std::uint64_t> dropped;
	for (const Layer &layer : layers_) {
		for (const auto &[id, body] : layer.bodies) {
			if (gone(id)) {
				dropped.push_back(id);
			}
		}
	}
	for (const std::uint64_t id : dropped) {
		drop(id);
	}
}

void CollisionRing::apply(const CollisionLayer::Settings &settings, const RID &body) {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	server->body_set_collision_layer(body, static_cast<std::uint32_t>(settings.layer));
	server->body_set_collision_mask(body, static_cast<std::uint32_t>(settings.mask));
	server->body_set_param(body, PhysicsServer3D::BODY_PARAM_FRICTION, settings.friction);
	server->body_set_param(body, PhysicsServer3D::BODY_PARAM_BOUNCE, settings.bounce);
}

Transform3D CollisionRing::transform_of(const Body &body) const {
	return to_engine(body.rotation, body.instance.position, offset_);
}

void CollisionRing::set_world_offset(glm::dvec3 offset) {
	offset_ = offset;
	for (const Layer &layer : layers_) {
		for (const auto &[id, body] : layer.bodies) {
			if (body.rid.is_valid()) {
				PhysicsServer3D::get_singleton()->body_set_state(
						body.rid, PhysicsServer3D::BODY_STATE_TRANSFORM, transform_of(body));
			}
		}
	}
}

RID CollisionRing::take_body() {
	if (!pool_.empty() && pool_.front().usable_at <= frame_) {
		// Fast path: one that has rested is as good as a new one.
		const RID body = pool_.front().rid;
		pool_.pop_front();
		return body;
	}
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	const RID body = server->body_create();
	server->body_set_mode(body, PhysicsServer3D::BODY_MODE_STATIC);
	server->body_attach_object_instance_id(body, node_id_);
	return body;
}

void CollisionRing::tidy_pool() {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	for (; still_in_space_ > 0; --still_in_space_) {
		server->body_set_space(pool_[pool_.size() - still_in_space_].rid, RID());
	}
	for (int i = 0; i < most_freed && pool_.size() > max_pooled && pool_.front().usable_at <= frame_; ++i) {
		owners_.erase(pool_.front().rid.get_id());
		server->free_rid(pool_.front().rid);
		pool_.pop_front();
	}
}

std::uint64_t CollisionRing::instance_of(const RID &body) const {
	const auto found = owners_.find(body.get_id());
	return found != owners_.end() ? found->second : 0;
}

void CollisionRing::clear() {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		fall_all(layer);
	}
	for (const Pooled &body : pool_) {
		PhysicsServer3D::get_singleton()->free_rid(body.rid);
	}
	queue_.forget_world();
	pool_.clear();
	still_in_space_ = 0;
	owners_.clear();
	shapes_.clear();
}

} // namespace thicket
