// This file contains the part of ScatterGroundColliders that tracks the scene. It finds the shapes
// of static bodies, checks them in turn, and reports changes.

#include "nodes/ground/scatter_ground_colliders.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/editor.hpp"
#include "nodes/common/watch.hpp"
#include "nodes/ground/changed_areas.hpp"
#include "nodes/ground/collider_shapes.hpp"

#include <godot_cpp/classes/animatable_body3d.hpp>
#include <godot_cpp/classes/collision_shape3d.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/static_body3d.hpp>
#include <godot_cpp/classes/window.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of scene nodes to visit per frame until all have been visited.
constexpr int visits_per_frame = 512;

/// The number of shape points to read per frame, which takes less than a millisecond. At least one
/// shape is read.
constexpr std::size_t points_per_frame = 100'000;

/// Returns the root of the nodes that may be ground. Excludes the editor's own nodes; the tree
/// contains thousands of them.
Node *root_of_scene(SceneTree &tree) { return in_editor() ? tree.get_edited_scene_root() : tree.get_root(); }

} // namespace

bool ScatterGroundColliders::is_in_scene() const { return first_node() != nullptr && first_node()->is_inside_tree(); }

/// Returns true for shapes of static bodies. Rays also hit moving bodies, but instances are not
/// updated when those move.
bool ScatterGroundColliders::follows(const Node *p_node) const {
	const auto *shape = Object::cast_to<CollisionShape3D>(p_node);
	const Node *body = shape != nullptr ? shape->get_parent() : nullptr;
	return Object::cast_to<StaticBody3D>(body) != nullptr && Object::cast_to<AnimatableBody3D>(body) == nullptr &&
			!belongs_to_scatter(body);
}

GroundWatch::ReadState ScatterGroundColliders::state_reader() const {
	return [mask = collision_mask_, world = first_node()->get_world_3d()](const Variant &p_node, Object *&r_source) {
		const auto *node = Object::cast_to<CollisionShape3D>(p_node.get_validated_object());
		if (node == nullptr || !node->is_inside_tree() || node->is_disabled()) {
			return GroundNodeState{};
		}
		const auto *body = Object::cast_to<StaticBody3D>(node->get_parent());
		const Ref<Shape3D> shape = node->get_shape();
		if (body == nullptr || shape.is_null() || (body->get_collision_layer() & mask) == 0 ||
				!(node->get_world_3d() == world)) {
			return GroundNodeState{};
		}
		r_source = shape.ptr();
		return GroundNodeState{node->get_global_transform(), shape->get_instance_id()};
	};
}

void ScatterGroundColliders::hosts_changed(bool first) {
	if (first) {
		start_over();
	}
}

/// Re-checks all shapes, because the scene may or may not have moved with the origin.
void ScatterGroundColliders::offset_changed(const GroundHost &) { watch_.touch_all(false); }

/// Discards all shapes and finds them again without reporting changes.
void ScatterGroundColliders::start_over() {
	watch(tree_.get_validated_object(), "node_added", this, "_node_added", false);
	tree_ = Variant();
	walk_.stop();
	watch_.clear();
	volumes_.clear();
	placed_.clear();
	offsets_.clear();
	queue_.clear();
	areas_.clear();
	everywhere_ = false;
}

void ScatterGroundColliders::follow() {
	figures_.checks = 0;
	points_ = 0;
	if (!is_in_scene()) {
		return;
	}
	if (tree_.get_validated_object() == nullptr) {
		SceneTree *tree = first_node()->get_tree();
		tree_ = Variant(tree);
		watch(tree, "node_added", this, "_node_added", true);
		walk_.start(root_of_scene(*tree));
		for (const GroundHost &host : hosts()) {
			offsets_[host.id] = host.offset;
		}
	}
	find_some();
	figures_.checks = watch_.check_next(state_reader());
	if (queue_.empty() && watch_.restless()) {
		const std::set<std::uint64_t> changed = watch_.take_changed();
		queue_.assign(changed.rbegin(), changed.rend());
		next_offsets_.clear();
		for (const GroundHost &host : hosts()) {
			next_offsets_[host.id] = host.offset;
		}
	}
	update_some();
}

/// Finds shapes that were in the tree before its `node_added` signal was connected.
void ScatterGroundColliders::find_some() {
	for (int visits = 0; visits < visits_per_frame && points_ < points_per_frame; ++visits) {
		Node *node = walk_.next();
		if (node == nullptr) {
			return;
		}
		if (VoxelVolumes::is_volume(node)) {
			volumes_.add(node);
		}
		const std::uint64_t id = node->get_instance_id();
		if (!follows(node) || watch_.has(id)) {
			continue;
		}
		watch_.add(id, Variant(node), state_reader(), false);
		if (const std::optional<Placed> placed = measure(id, nullptr)) {
			placed_[id] = *placed;
		}
	}
}

void ScatterGroundColliders::node_added(Node *p_node) {
	if (VoxelVolumes::is_volume(p_node)) {
		volumes_.add(p_node);
	}
	if (is_in_scene() && follows(p_node)) {
		watch_.add(p_node->get_instance_id(), Variant(p_node), state_reader(), true);
	}
}

/// Returns the current state of a shape; empty if it is not ground. Reuses the bounds of its
/// previous state `before`, which may be null, unless the shape has reported a change.
std::optional<ScatterGroundColliders::Placed> ScatterGroundColliders::measure(std::uint64_t id, const Placed *before) {
	const Variant *node = watch_.node(id);
	Object *source = nullptr;
	GroundNodeState sight = node != nullptr ? state_reader()(*node, source) : GroundNodeState{};
	if (sight.source == 0) {
		return std::nullopt;
	}
	sight.version = watch_.version(sight.source);
	if (before != nullptr && before->sight.source == sight.source && before->sight.version == sight.version) {
		// The shape itself is unchanged, even if its body has moved.
		return Placed{sight, before->bounds};
	}
	++figures_.reads;
	return Placed{sight, bounds_of(Ref<Shape3D>(Object::cast_to<Shape3D>(source)), points_)};
}

/// Processes the next shapes of the queue. Reports all changes after the last one.
void ScatterGroundColliders::update_some() {
	if (queue_.empty()) {
		return;
	}
	for (std::size_t updated = 0; !queue_.empty() && updated < GroundWatch::nodes_per_frame; ++updated) {
		if (points_ >= points_per_frame) {
			return;
		}
		const std::uint64_t id = queue_.back();
		queue_.pop_back();
		update(id);
	}
	if (queue_.empty()) {
		offsets_ = std::exchange(next_offsets_, {});
		notify();
	}
}

void ScatterGroundColliders::update(std::uint64_t id) {
	const auto found = placed_.find(id);
	const Placed *before = found != placed_.end() ? &found->second : nullptr;
	const std::optional<Placed> now = measure(id, before);
	for (const auto &[host, offset] : next_offsets_) {
		const auto then = offsets_.find(host);
		const glm::dvec3 offset_before = then != offsets_.end() ? then->second : offset;
		if (before != nullptr && now && same_in_world(before->sight, offset_before, now->sight, offset)) {
			// The shape has not moved in this host's world.
			continue;
		}
		if (before != nullptr) {
			add_area(*before, offset_before);
		}
		if (now) {
			add_area(*now, offset);
		}
	}
	if (now) {
		placed_[id] = *now;
		return;
	}
	placed_.erase(id);
	const Variant *node = watch_.node(id);
	const auto *shape = node != nullptr ? Object::cast_to<Node>(node->get_validated_object()) : nullptr;
	if (shape == nullptr || !shape->is_inside_tree()) {
		watch_.remove(id); // If it is added again, the tree emits a signal.
	}
}

void ScatterGroundColliders::add_area(const Placed &placed, glm::dvec3 offset) {
	everywhere_ = everywhere_ || !placed.bounds;
	if (placed.bounds) {
		const Rect area = area_of(*placed.bounds, placed.sight.frame);
		const glm::dvec2 by(offset.x, offset.z);
		add_changed_area(areas_, {area.min + by, area.max + by});
	}
}

void ScatterGroundColliders::notify() {
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	const std::vector<Rect> areas = std::exchange(areas_, {});
	if (std::exchange(everywhere_, false)) {
		emit_ground_changed(Rect2());
		return;
	}
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
}

void ScatterGroundColliders::source_changed(int64_t p_source) { watch_.source_changed(core_id(p_source)); }

} // namespace thicket
