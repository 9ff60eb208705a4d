#include "nodes/gameplay/collision_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/physics_server3d.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of recent offsets whose bodies are searched for around the viewers.
constexpr std::size_t most_offsets = 8;

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
		result.shape.meshes = layer->drawing.finest_meshes();
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
	layers_.resize(std::max(layers_.size(), layers.size()));
	layers.resize(layers_.size());
	std::vector<double> distances;
	std::vector<std::uint32_t> changed;
	for (std::uint32_t index = 0; index < layers.size(); ++index) {
		Layer &layer = layers_[index];
		CollisionLayer &next = layers[index];
		const bool collides = next.shape.kind != ScatterLayer::COLLISION_NONE;
		distances.push_back(collides ? next.distance : 0.0);
		const bool same_settings = layer.is.settings == next.settings;
		const bool same_shape = layer.is.shape == next.shape;
		layer.settings_version = same_settings ? layer.settings_version : ++last_version_;
		layer.shape_version = same_shape ? layer.shape_version : ++last_version_;
		layer.is = std::move(next);
		if (collides && !(same_settings && same_shape)) {
			changed.push_back(index);
		}
	}
	queue_.set_distances(distances);
	for (const std::uint32_t index : changed) {
		queue_.renew(index);
	}
}

void CollisionRing::look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	if (space_.is_valid()) {
		++frame_;
		queue_.look_around(centers, world);
	}
}

bool CollisionRing::step() {
	const bool removed = remove_some();
	const bool renewed = renew_some();
	PlacedInstance instance;
	const bool entered = queue_.next_entering(instance);
	if (entered) {
		stand(instance);
	}
	if (removed || renewed || entered) {
		return true;
	}
	const bool tidied = tidy_some(); // Nothing collides with these bodies, so they can wait.
	return shapes_.free_some() || tidied;
}

/// Handles removed instances first, because a player must not run into them. Instances that are only far away can wait.
bool CollisionRing::remove_some() {
	int count = 0;
	Leaving leaving;
	for (; count < most_per_step && queue_.next_gone(leaving); ++count) {
		leave(leaving);
	}
	for (; count < most_per_step && queue_.next_leaving(leaving); ++count) {
		leave(leaving);
	}
	return count > 0;
}

/// Updates moved instances, and bodies of layers that have changed.
bool CollisionRing::renew_some() {
	int count = 0;
	PlacedInstance instance;
	for (; count < most_per_step && queue_.next_changed(instance); ++count) {
		stand(instance);
	}
	for (; count < most_per_step && queue_.next_due(instance); ++count) {
		renew(instance);
	}
	if (count == 0) {
		offsets_before_.clear();
	}
	return count > 0;
}

/// Updates a body to its layer's settings and to the world offset.
void CollisionRing::renew(const PlacedInstance &instance) {
	Layer &layer = layers_[instance.layer];
	const auto found = layer.bodies.find(instance.id);
	if (found == layer.bodies.end()) {
		return;
	}
	Body &body = found->second;
	if (body.shape_version != layer.shape_version) {
		stand(PlacedInstance(body.instance));
		return;
	}
	if (body.settings_version != layer.settings_version && body.rid.is_valid()) {
		apply(layer.is.settings, body.rid);
	}
	body.settings_version = layer.settings_version;
	if (body.offset != offset_) {
		place(body);
	}
}

/// Replaces the body that the instance has by now, if any.
void CollisionRing::stand(const PlacedInstance &instance) {
	fall(instance.layer, instance.id);
	Layer &layer = layers_[instance.layer];
	Body &body = layer.bodies[instance.id];
	body.instance = instance;
	body.settings_version = layer.settings_version;
	body.shape_version = layer.shape_version;
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
	place(body);
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
		pool_.push_back({body.rid, frame_});
		++still_in_space_;
		shapes_.give_back(body.shapes);
	}
}

/// If the instance has since been found in a different cell of the queue, it has a body there, which stays.
void CollisionRing::leave(const Leaving &leaving) {
	const auto &bodies = layers_[leaving.layer].bodies;
	const auto found = bodies.find(leaving.id);
	if (found != bodies.end() && found->second.instance.position == leaving.position) {
		fall(leaving.layer, leaving.id);
	}
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

void CollisionRing::place(Body &r_body) {
	r_body.offset = offset_;
	if (r_body.rid.is_valid()) {
		PhysicsServer3D::get_singleton()->body_set_state(r_body.rid, PhysicsServer3D::BODY_STATE_TRANSFORM,
				to_engine(r_body.rotation, r_body.instance.position, offset_));
	}
}

/// Moves two groups of bodies immediately, because the physics of the same frame may touch them: the bodies around the
/// viewers, and bodies that would otherwise stay at the viewers' positions in the engine's space. The other bodies
/// follow step by step.
void CollisionRing::set_world_offset(glm::dvec3 offset) {
	if (offset == offset_) {
		return;
	}
	offsets_before_.push_back(offset_);
	if (offsets_before_.size() > most_offsets) {
		offsets_before_.erase(offsets_before_.begin());
	}
	offset_ = offset;
	std::vector<glm::dvec3> positions(queue_.centers().begin(), queue_.centers().end());
	for (const glm::dvec3 &center : queue_.centers()) {
		for (const glm::dvec3 &before : offsets_before_) {
			positions.push_back(center - offset + before);
		}
	}
	for (const PlacedInstance &instance : queue_.held_within(positions, moved_reach, moved_at_once)) {
		renew(instance);
	}
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		queue_.renew(layer);
	}
}

RID CollisionRing::take_body() {
	if (pool_.size() > still_in_space_ && rested(pool_.front())) {
		// A body that has rested is reused.
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

/// Takes bodies that fell in earlier frames out of the space, and frees those that the pool does not need.
bool CollisionRing::tidy_some() {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	int count = 0;
	for (; count < most_per_step && still_in_space_ > 0; ++count, --still_in_space_) {
		const Pooled &oldest = pool_[pool_.size() - still_in_space_];
		if (oldest.fell_at == frame_) {
			break;
		}
		server->body_set_space(oldest.rid, RID());
	}
	for (; count < most_per_step && pool_.size() > max_pooled + still_in_space_ && rested(pool_.front()); ++count) {
		owners_.erase(pool_.front().rid.get_id());
		server->free_rid(pool_.front().rid);
		pool_.pop_front();
	}
	return count > 0;
}

std::uint64_t CollisionRing::instance_of(const RID &body) const {
	const auto found = owners_.find(body.get_id());
	return found != owners_.end() ? found->second : 0;
}

void CollisionRing::clear() {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		while (!layers_[layer].bodies.empty()) {
			fall(layer, layers_[layer].bodies.begin()->first);
		}
		queue_.release_layer(layer);
	}
	for (const Pooled &body : pool_) {
		PhysicsServer3D::get_singleton()->free_rid(body.rid);
	}
	queue_.forget_world();
	offsets_before_.clear();
	pool_.clear();
	still_in_space_ = 0;
	owners_.clear();
	shapes_.clear();
}

} // namespace thicket
