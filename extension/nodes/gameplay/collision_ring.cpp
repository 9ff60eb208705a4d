#include "nodes/gameplay/collision_ring.hpp"

#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/physics_server3d.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The maximum number of earlier world frames to remember. Bodies that are still placed with one of
/// them may appear near the viewers.
constexpr std::size_t max_frames = 8;

/// World frames that differ by at most this many meters at every viewer are treated as equal.
constexpr double same_frame_tolerance = 4.0;

/// The search for bodies near the viewers is repeated after one of the searched positions has moved
/// by more than this many meters.
constexpr double search_tolerance = 1.0;

/// Returns true if a new world frame moves any of the positions by more than `distance` meters.
bool moves_by(double distance, const WorldFrame &from, const WorldFrame &to, std::span<const glm::dvec3> positions) {
	return std::ranges::any_of(positions, [&](glm::dvec3 position) {
		return glm::distance(from.to_engine(position), to.to_engine(position)) > distance;
	});
}

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
	std::vector<std::uint32_t> changed_layers;
	for (std::uint32_t index = 0; index < layers.size(); ++index) {
		Layer &layer = layers_[index];
		CollisionLayer &next = layers[index];
		const bool collides = next.shape.kind != ScatterLayer::COLLISION_NONE;
		distances.push_back(collides ? next.distance : 0.0);
		const bool same_settings = layer.config.settings == next.settings;
		const bool same_shape = layer.config.shape == next.shape;
		layer.settings_version = same_settings ? layer.settings_version : ++last_version_;
		layer.shape_version = same_shape ? layer.shape_version : ++last_version_;
		layer.config = std::move(next);
		if (collides && !(same_settings && same_shape)) {
			changed_layers.push_back(index);
		}
	}
	queue_.set_distances(distances);
	for (const std::uint32_t index : changed_layers) {
		queue_.renew(index);
	}
}

void CollisionRing::find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	if (space_.is_valid()) {
		++frame_;
		queue_.find_changes(centers, world);
	}
}

bool CollisionRing::step() {
	const bool any_removed = remove_some();
	const bool any_renewed = renew_some();
	PlacedInstance instance;
	const bool any_entered = queue_.next_entering(instance);
	if (any_entered) {
		create_body(instance);
	}
	if (any_removed || any_renewed || any_entered) {
		return true;
	}
	// Nothing collides with removed bodies, so they have the lowest priority.
	const bool any_tidied = tidy_pool();
	return shapes_.free_some() || any_tidied;
}

/// Removes the bodies of removed instances first, because players must not collide with them.
/// Bodies that are merely out of range can wait.
bool CollisionRing::remove_some() {
	int count = 0;
	InstanceToRelease release;
	for (; count < max_per_step && queue_.next_removed(release); ++count) {
		remove_released(release);
	}
	for (; count < max_per_step && queue_.next_leaving(release); ++count) {
		remove_released(release);
	}
	return count > 0;
}

/// Replaces the bodies of changed instances, then updates bodies whose layer or world frame has
/// changed.
bool CollisionRing::renew_some() {
	int count = 0;
	PlacedInstance instance;
	for (; count < max_per_step && queue_.next_changed(instance); ++count) {
		create_body(instance);
	}
	for (; count < max_per_step && queue_.next_due(instance); ++count) {
		renew(instance.layer, instance.id);
	}
	return count > 0 || move_some();
}

/// Moves the next bodies of the round to the current world frame. A round visits every body once.
/// It does not restart when the world moves again, so it reaches every body even if the world moves
/// every frame. Returns false at the end of a round.
bool CollisionRing::move_some() {
	int count = 0;
	for (; count < max_per_step && next_to_move_ < placed_bodies_.size(); ++count, ++next_to_move_) {
		if (Body &body = *placed_bodies_[next_to_move_]; body.frame != world_frame_) {
			place(body);
		}
	}
	if (count > 0) {
		return true;
	}
	earlier_frames_.clear();
	if (round_frame_ != world_frame_) {
		earlier_frames_.push_back(std::exchange(round_frame_, world_frame_));
		next_to_move_ = 0;
	}
	return false; // Lets `step` tidy up between rounds.
}

/// Applies the layer's current settings and the current world frame to the body of an instance.
void CollisionRing::renew(std::uint32_t index, std::uint64_t id) {
	Layer &layer = layers_[index];
	const auto entry = layer.bodies.find(id);
	if (entry == layer.bodies.end()) {
		return;
	}
	Body &body = entry->second;
	if (body.shape_version != layer.shape_version) {
		create_body(PlacedInstance(body.instance));
		return;
	}
	if (body.settings_version != layer.settings_version && body.rid.is_valid()) {
		apply(layer.config.settings, body.rid);
	}
	body.settings_version = layer.settings_version;
	if (body.frame != world_frame_) {
		place(body);
	}
}

/// Creates the body of an instance and removes its previous body, if any.
void CollisionRing::create_body(const PlacedInstance &instance) {
	remove_body(instance.layer, instance.id);
	Layer &layer = layers_[instance.layer];
	Body &body = layer.bodies[instance.id];
	body.instance = instance;
	body.settings_version = layer.settings_version;
	body.shape_version = layer.shape_version;
	if (BodyFit fit; fit_body(instance.basis, fit)) {
		body.rotation = fit.rotation;
		body.shapes = shapes_.take(layer.config.shape, instance.mesh, fit);
	}
	if (body.shapes.empty()) {
		return;
	}
	body.rid = take_body();
	apply(layer.config.settings, body.rid);
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	for (const CollisionShapes::PlacedShape &placed : body.shapes) {
		server->body_add_shape(body.rid, placed.shape->rid, to_engine(placed.rotation, placed.origin, WorldFrame()));
	}
	place(body);
	server->body_set_space(body.rid, space_);
	instance_ids_[body.rid.get_id()] = instance.id;
	body.slot = placed_bodies_.size();
	placed_bodies_.push_back(&body);
}

/// Removes a body from `placed_bodies_`. The last body takes its slot.
void CollisionRing::unlist(const Body &body) {
	Body &last = *placed_bodies_.back();
	placed_bodies_[body.slot] = &last;
	last.slot = body.slot;
	placed_bodies_.pop_back();
	if (body.slot < next_to_move_ && &last != &body && last.frame != world_frame_) {
		place(last); // The round has already visited its new slot.
	}
	next_to_move_ = std::min(next_to_move_, placed_bodies_.size());
}

void CollisionRing::remove_body(std::uint32_t layer, std::uint64_t id) {
	auto &bodies = layers_[layer].bodies;
	const auto entry = bodies.find(id);
	if (entry == bodies.end()) {
		return;
	}
	if (entry->second.rid.is_valid()) {
		unlist(entry->second);
	}
	const Body body = std::move(entry->second);
	bodies.erase(entry);
	if (body.rid.is_valid()) {
		PhysicsServer3D::get_singleton()->body_clear_shapes(body.rid);
		pool_.push_back({body.rid, frame_});
		++in_space_count_;
		shapes_.give_back(body.shapes);
	}
}

/// Removes the body of an instance, unless the queue has since found the instance in another cell.
/// The instance then has a new body at another position.
void CollisionRing::remove_released(const InstanceToRelease &release) {
	const auto &bodies = layers_[release.layer].bodies;
	const auto entry = bodies.find(release.id);
	if (entry != bodies.end() && entry->second.instance.position == release.position) {
		remove_body(release.layer, release.id);
	}
}

void CollisionRing::drop(std::uint64_t id) {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		remove_body(layer, id);
	}
	queue_.release(id);
}

void CollisionRing::drop_if(const std::function<bool(std::uint64_t id)> &is_gone) {
	std::vector<std::uint64_t> dropped_ids;
	for (const Layer &layer : layers_) {
		for (const auto &[id, body] : layer.bodies) {
			if (is_gone(id)) {
				dropped_ids.push_back(id);
			}
		}
	}
	for (const std::uint64_t id : dropped_ids) {
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
	r_body.frame = world_frame_;
	if (r_body.rid.is_valid()) {
		PhysicsServer3D::get_singleton()->body_set_state(r_body.rid, PhysicsServer3D::BODY_STATE_TRANSFORM,
				to_engine(r_body.rotation, r_body.instance.position, world_frame_));
	}
}

/// Moves two groups of bodies immediately, because viewers may touch them in this physics frame.
/// One group is the bodies around the viewers. The other is bodies whose outdated frames place
/// them at the viewers' positions in the engine's space. `step` moves the rest.
void CollisionRing::set_world_frame(const WorldFrame &frame) {
	if (frame == world_frame_) {
		return;
	}
	const std::span<const glm::dvec3> centers = queue_.centers();
	if (earlier_frames_.empty() || moves_by(same_frame_tolerance, earlier_frames_.back(), world_frame_, centers)) {
		earlier_frames_.push_back(world_frame_);
	}
	if (earlier_frames_.size() > max_frames) {
		earlier_frames_.erase(earlier_frames_.begin());
	}
	// After a jump, the bodies must move in order of distance.
	const bool is_jump = moves_by(moved_radius, world_frame_, frame, centers);
	world_frame_ = frame;
	std::vector<glm::dvec3> positions(centers.begin(), centers.end());
	for (const glm::dvec3 &center : centers) {
		for (const WorldFrame &earlier_frame : earlier_frames_) {
			const glm::dvec3 outdated_position = earlier_frame.to_world(frame.to_engine(center));
			if (glm::distance(outdated_position, center) > same_frame_tolerance) {
				positions.push_back(outdated_position);
			}
		}
	}
	find_nearest(positions);
	for (const NearHeld &body : nearest_) {
		renew(body.layer, body.id);
	}
	if (is_jump) {
		// The queue moves all bodies, nearest first, so no round is needed.
		round_frame_ = world_frame_;
		next_to_move_ = placed_bodies_.size();
		for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
			queue_.renew(layer);
		}
	}
}

/// Finds the bodies near the positions, which are moved immediately. The search costs more than the
/// moves, so its result is reused for a few frames unless a position moves too far.
void CollisionRing::find_nearest(std::span<const glm::dvec3> positions) {
	constexpr std::uint64_t max_search_age = 8;
	if (frame_ < search_frame_ + max_search_age && same_within(search_tolerance, positions, search_positions_)) {
		return;
	}
	nearest_ = queue_.held_within(positions, moved_radius, max_moved_immediately);
	search_positions_.assign(positions.begin(), positions.end());
	search_frame_ = frame_;
}

RID CollisionRing::take_body() {
	if (pool_.size() > in_space_count_ && is_reusable(pool_.front())) {
		// Reuse the body that was removed first.
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

/// Removes bodies from the physics space that were put into the pool in earlier frames, and frees those that
/// exceed the pool's size. Returns true if it did any work.
bool CollisionRing::tidy_pool() {
	PhysicsServer3D *server = PhysicsServer3D::get_singleton();
	int count = 0;
	for (; count < max_per_step && in_space_count_ > 0; ++count, --in_space_count_) {
		const PooledBody &oldest = pool_[pool_.size() - in_space_count_];
		if (oldest.removed_frame == frame_) {
			break;
		}
		server->body_set_space(oldest.rid, RID());
	}
	for (; count < max_per_step && pool_.size() > max_pooled + in_space_count_ && is_reusable(pool_.front()); ++count) {
		instance_ids_.erase(pool_.front().rid.get_id());
		server->free_rid(pool_.front().rid);
		pool_.pop_front();
	}
	return count > 0;
}

std::uint64_t CollisionRing::instance_of(const RID &body) const {
	const auto entry = instance_ids_.find(body.get_id());
	return entry != instance_ids_.end() ? entry->second : 0;
}

void CollisionRing::clear() {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		while (!layers_[layer].bodies.empty()) {
			remove_body(layer, layers_[layer].bodies.begin()->first);
		}
		queue_.release_layer(layer);
	}
	for (const PooledBody &body : pool_) {
		PhysicsServer3D::get_singleton()->free_rid(body.rid);
	}
	queue_.forget_world();
	earlier_frames_.clear();
	round_frame_ = world_frame_;
	nearest_.clear();
	search_positions_.clear();
	pool_.clear();
	in_space_count_ = 0;
	instance_ids_.clear();
	shapes_.clear();
}

} // namespace thicket
