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

/// Returns the root of the nodes that may be ground. Excludes the thousands of nodes of the editor
/// itself.
Node *root_of_scene(SceneTree &tree) { return in_editor() ? tree.get_edited_scene_root() : tree.get_root(); }

} // namespace

bool ScatterGroundColliders::is_in_scene() const { return first_node() != nullptr && first_node()->is_inside_tree(); }

/// Returns true for shapes of static bodies. Rays also hit moving bodies, but instances are not
/// updated when those move.
bool ScatterGroundColliders::is_ground_shape(const Node *p_node) const {
	const auto *shape = Object::cast_to<CollisionShape3D>(p_node);
	const Node *body = shape != nullptr ? shape->get_parent() : nullptr;
	return Object::cast_to<StaticBody3D>(body) != nullptr && Object::cast_to<AnimatableBody3D>(body) == nullptr &&
			!belongs_to_scatter(body);
}

/// Returns a function that reads the state of a shape. Shapes that are disabled, or that the mask
/// excludes, are not ground.
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
void ScatterGroundColliders::offset_changed(const GroundHost &) { watch_.mark_all_changed(false); }

/// Discards all shapes and finds them again without reporting changes.
void ScatterGroundColliders::start_over() {
	watch(tree_.get_validated_object(), "node_added", this, "_node_added", false);
	tree_ = Variant();
	walk_.stop();
	watch_.clear();
	volumes_.clear();
	shapes_.clear();
	offsets_.clear();
	queue_.clear();
	areas_.clear();
	changed_everywhere_ = false;
}

void ScatterGroundColliders::follow() {
	figures_.checks = 0;
	points_read_ = 0;
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
	find_next_shapes();
	figures_.checks = watch_.check_next(state_reader());
	if (queue_.empty() && watch_.has_changes()) {
		const std::set<std::uint64_t> changed_ids = watch_.take_changed();
		queue_.assign(changed_ids.rbegin(), changed_ids.rend());
		next_offsets_.clear();
		for (const GroundHost &host : hosts()) {
			next_offsets_[host.id] = host.offset;
		}
	}
	update_next_shapes();
}

/// Finds shapes that were in the tree before its `node_added` signal was connected.
void ScatterGroundColliders::find_next_shapes() {
	for (int visits = 0; visits < visits_per_frame && points_read_ < points_per_frame; ++visits) {
		Node *node = walk_.next();
		if (node == nullptr) {
			return;
		}
		if (VoxelVolumes::is_volume(node)) {
			volumes_.add(node);
		}
		const std::uint64_t id = node->get_instance_id();
		if (!is_ground_shape(node) || watch_.has(id)) {
			continue;
		}
		watch_.add(id, Variant(node), state_reader(), false);
		if (const std::optional<ShapeState> shape = measure(id, nullptr)) {
			shapes_[id] = *shape;
		}
	}
}

void ScatterGroundColliders::node_added(Node *p_node) {
	if (VoxelVolumes::is_volume(p_node)) {
		volumes_.add(p_node);
	}
	if (is_in_scene() && is_ground_shape(p_node)) {
		watch_.add(p_node->get_instance_id(), Variant(p_node), state_reader(), true);
	}
}

/// Returns the current state of a shape; empty if it is not ground. Reuses the bounds of its
/// previous state `before`, which may be null, unless the shape has reported a change.
std::optional<ScatterGroundColliders::ShapeState> ScatterGroundColliders::measure(
		std::uint64_t id, const ShapeState *before) {
	const Variant *node = watch_.node(id);
	Object *source = nullptr;
	GroundNodeState state = node != nullptr ? state_reader()(*node, source) : GroundNodeState{};
	if (state.source == 0) {
		return std::nullopt;
	}
	state.version = watch_.version(state.source);
	if (before != nullptr && before->state.source == state.source && before->state.version == state.version) {
		// The shape itself is unchanged, even if its body has moved.
		return ShapeState{state, before->bounds};
	}
	++figures_.reads;
	return ShapeState{state, bounds_of(Ref<Shape3D>(Object::cast_to<Shape3D>(source)), points_read_)};
}

/// Processes the next shapes of the queue. Reports all changes after the last one.
void ScatterGroundColliders::update_next_shapes() {
	if (queue_.empty()) {
		return;
	}
	for (std::size_t count = 0; !queue_.empty() && count < GroundWatch::nodes_per_frame; ++count) {
		if (points_read_ >= points_per_frame) {
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

/// Compares a shape with its last state. Adds the areas of both states if it has changed.
void ScatterGroundColliders::update(std::uint64_t id) {
	const auto entry = shapes_.find(id);
	const ShapeState *before = entry != shapes_.end() ? &entry->second : nullptr;
	const std::optional<ShapeState> current_state = measure(id, before);
	for (const auto &[host, offset] : next_offsets_) {
		const auto previous_offset = offsets_.find(host);
		const glm::dvec3 offset_before = previous_offset != offsets_.end() ? previous_offset->second : offset;
		if (before != nullptr && current_state &&
				same_in_world(before->state, offset_before, current_state->state, offset)) {
			// The shape has not moved in this host's world.
			continue;
		}
		if (before != nullptr) {
			add_area(*before, offset_before);
		}
		if (current_state) {
			add_area(*current_state, offset);
		}
	}
	if (current_state) {
		shapes_[id] = *current_state;
		return;
	}
	shapes_.erase(id);
	const Variant *node = watch_.node(id);
	const auto *shape = node != nullptr ? Object::cast_to<Node>(node->get_validated_object()) : nullptr;
	if (shape == nullptr || !shape->is_inside_tree()) {
		watch_.remove(id); // If it is added again, the tree emits a signal.
	}
}

void ScatterGroundColliders::add_area(const ShapeState &shape, glm::dvec3 offset) {
	changed_everywhere_ = changed_everywhere_ || !shape.bounds;
	if (shape.bounds) {
		const Rect area = area_of(*shape.bounds, shape.state.frame);
		const glm::dvec2 shift(offset.x, offset.z);
		add_changed_area(areas_, {area.min + shift, area.max + shift});
	}
}

/// Emits signals for the changed areas.
void ScatterGroundColliders::notify() {
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	const std::vector<Rect> areas = std::exchange(areas_, {});
	if (std::exchange(changed_everywhere_, false)) {
		emit_ground_changed(Rect2());
		return;
	}
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
}

void ScatterGroundColliders::source_changed(int64_t p_source) { watch_.source_changed(core_id(p_source)); }

} // namespace thicket
