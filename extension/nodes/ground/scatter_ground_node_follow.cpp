// This file contains the part of ScatterGroundNode that tracks its node through signals and, for
// changes that emit none, by polling every frame.

#include "nodes/ground/scatter_ground_node.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/editor.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/classes/scene_tree.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of height samples in each direction that affect the ground at a position, because of
/// interpolation and slopes.
constexpr real_t post_margin = 2;

/// The maximum number of areas to report. If there are more, the ground is reported as changed
/// everywhere.
constexpr std::size_t max_areas = 256;

Rect2 grow(const Rect2 &rect, real_t margin) {
	return {rect.position.x - margin, rect.position.y - margin, rect.size.x + 2 * margin, rect.size.y + 2 * margin};
}

} // namespace

void ScatterGroundNode::follow_node(Node *p_target, Object *p_source) {
	unfollow_node();
	followed_node_ = Variant(p_target);
	followed_source_ = Variant(p_source);
	connect_signals(true);
}

void ScatterGroundNode::unfollow_node() {
	connect_signals(false);
	followed_node_ = Variant();
	followed_source_ = Variant();
}

// Connects or disconnects the node's signals. Only the signals of Terrain3D (maps_edited in the
// editor, and those for the other maps and the region map) and of HTerrain report edits.
void ScatterGroundNode::connect_signals(bool p_connect) {
	const auto set_connected = [this, p_connect](Object *object, const StringName &signal, const StringName &method) {
		if (object != nullptr && object->has_signal(signal)) {
			watch(object, signal, this, method, p_connect);
		}
	};
	Object *node = followed_node_.get_validated_object();
	Object *source = followed_source_.get_validated_object();
	set_connected(node, "tree_exiting", "_node_gone");
	set_connected(node, "tree_entered", "_change");
	const bool is_queried = !is_copy_present_ && is_available();
	const bool has_map = is_queried && ground_->map() != nullptr;
	if (!is_queried || has_map || !p_connect) {
		set_connected(source, "region_changed", "_map_edited");
	}
	// The node is copied, or may be copied once it has all required data.
	if (!is_queried || !p_connect) {
		for (const char *const signal : {"transform_changed", "material_changed"}) {
			set_connected(node, signal, "_source_edited");
		}
		for (const char *const signal : {"maps_edited", "maps_changed", "region_map_changed", "height_maps_changed",
					 "control_maps_changed", "resolution_changed", "map_added", "map_removed", "map_changed"}) {
			set_connected(source, signal, "_source_edited");
		}
	}
	if (has_map || !p_connect) {
		set_connected(node, "transform_changed", "_node_moved");
	}
	if ((is_queried && !has_map) || !p_connect) {
		set_connected(source, "maps_edited", "_area_edited");
		set_connected(source, "maps_changed", "_maps_changed");
	}
}

void ScatterGroundNode::follow_frames(bool p_follow) {
	SceneTree *tree = p_follow ? first_node()->get_tree() : nullptr;
	if (Object *before = followed_tree_.get_validated_object(); before != tree) {
		watch(before, "process_frame", this, "_poll", false);
	}
	followed_tree_ = Variant(tree);
	watch(tree, "process_frame", this, "_poll", true);
}

void ScatterGroundNode::hosts_changed(bool) {
	is_stale_ = true;
	follow_frames(!hosts().empty());
	if (hosts().empty()) {
		unfollow_node();
		close(); // From now on, no signal reports that the node is freed.
	}
}

std::vector<glm::dvec3> ScatterGroundNode::host_offsets() const {
	std::vector<glm::dvec3> offsets;
	for (const GroundHost &host : hosts()) {
		offsets.push_back(host.offset);
	}
	return offsets;
}

void ScatterGroundNode::offset_changed(const GroundHost &host) {
	// Compare copies again, because they contain positions in the engine's space, and the node may
	// or may not have moved with the origin.
	must_copy_again_ = true;
	for (const HostObject &object : std::vector(host_objects_)) {
		const std::shared_ptr<ObjectGround> ground = object.host == host.id ? object.ground.lock() : nullptr;
		if (ground != nullptr) {
			ground->set_offset(host.offset);
		}
	}
}

void ScatterGroundNode::change() {
	is_stale_ = true;
	are_users_notified_ = true;
	changes_ = {};
	emit_changed();
}

void ScatterGroundNode::node_gone() {
	close();
	change();
}

void ScatterGroundNode::node_moved(const Transform3D &) { change(); }

/// Emits `ground_changed` for an area in the engine's space, once for each world position at which
/// a host has that area.
void ScatterGroundNode::emit_area(const Rect2 &p_rect) {
	std::vector<glm::dvec2> corners;
	for (const GroundHost &host : hosts()) {
		const glm::dvec2 corner = to_core(p_rect.position) + glm::dvec2(host.offset.x, host.offset.z);
		if (std::ranges::find(corners, corner) == corners.end()) {
			corners.push_back(corner);
		}
	}
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	const bool was_emitting = std::exchange(is_emitting_, true);
	for (const glm::dvec2 corner : corners) {
		emit_ground_changed(Rect2(to_engine(corner), p_rect.size));
	}
	is_emitting_ = was_emitting;
}

void ScatterGroundNode::area_edited(const AABB &p_area) {
	const Object *node = followed_node_.get_validated_object();
	const Variant spacing = node != nullptr ? node->get("vertex_spacing") : Variant();
	const real_t margin = is_number(spacing) ? post_margin * std::max<real_t>(spacing, 0) : 0;
	emit_area(grow({p_area.position.x, p_area.position.z, p_area.size.x, p_area.size.z}, margin));
}

/// Handles the signal `maps_changed`. In the editor the signal is ignored, because it accompanies
/// the edited area of each brush stroke and would regenerate all tiles each time.
void ScatterGroundNode::maps_changed() {
	if (!in_editor()) {
		change();
	}
}

/// Handles an edit to the map. HTerrain up to version 1.8 passes x, z, width, depth and the kind of
/// map. Later versions pass a Rect2i, the kind of map and the index of the map.
void ScatterGroundNode::map_edited(const Variant &p_x, const Variant &p_z, const Variant &p_width,
		const Variant &p_depth, const Variant &p_channel) {
	Rect2i edited_rect;
	const bool is_rect = p_x.get_type() == Variant::RECT2I && is_number(p_z);
	if (is_rect) {
		edited_rect = p_x;
	} else if (is_number(p_x) && is_number(p_z) && is_number(p_width) && is_number(p_depth) && is_number(p_channel)) {
		edited_rect = {Vector2i(static_cast<int32_t>(p_x), static_cast<int32_t>(p_z)),
				Vector2i(static_cast<int32_t>(p_width), static_cast<int32_t>(p_depth))};
	} else {
		change(); // Unknown arguments, so anything may have changed.
		return;
	}
	const std::int64_t channel = is_rect ? p_z : p_channel;
	if (is_copy_present_) {
		must_copy_again_ = must_copy_again_ || edits_.size() >= max_areas;
		// The older arguments do not include the index of the map.
		edits_.push_back(
				{channel, is_rect && is_number(p_width) ? static_cast<std::int64_t>(p_width) : -1, edited_rect});
	} else if (!is_available()) {
		must_copy_again_ = true;
	} else if (ground_->map() != nullptr) {
		is_stale_ = is_stale_ || TerrainMap::copies(channel);
		const Rect2 rect(static_cast<real_t>(edited_rect.position.x), static_cast<real_t>(edited_rect.position.y),
				static_cast<real_t>(edited_rect.size.x), static_cast<real_t>(edited_rect.size.y));
		emit_area(ground_->map()->world_rect(grow(rect, post_margin)));
	}
}

/// Records that a copied ground may have changed. `poll` copies it again and compares the copies,
/// at most once per frame.
void ScatterGroundNode::source_edited(const Variant &, const Variant &) { must_copy_again_ = true; }

/// Detects nodes that were added, removed or replaced without a signal, and processes reported
/// changes. Called every frame.
void ScatterGroundNode::poll() {
	const Ref<ScatterGround> keep_alive(this);
	const Node3D *host_node = first_node();
	if (is_finding_ || is_stale_ || host_node == nullptr || !host_node->is_inside_tree()) {
		return;
	}
	is_finding_ = true;
	const Variant target(String(node_).is_empty() ? nullptr : host_node->get_node_or_null(node_));
	const GroundFingerprint fingerprint = fingerprint_of(target, copy_ != nullptr || !is_available());
	is_finding_ = false;
	if (is_stale_) {
		return;
	}
	if (!(fingerprint == fingerprint_)) {
		fingerprint_ = fingerprint;
		change();
		return;
	}
	if (is_copy_present_ && !must_copy_again_) {
		const std::shared_ptr<const GroundCopy> copy = copy_; // A called script may release `copy_`.
		is_finding_ = true;
		must_copy_again_ = copy->is_outdated(target) || must_copy_again_;
		is_finding_ = false;
	}
	if (is_copy_present_ && (must_copy_again_ || !edits_.empty())) {
		update_copy();
	} else if (std::exchange(must_copy_again_, false) && !is_available()) {
		change(); // The node may now have the data that it lacked before.
		return;
	}
	notify();
}

/// Applies reported edits to the copy or, if that is not possible, copies the ground again.
void ScatterGroundNode::update_copy() {
	Examination examination;
	examination.target = followed_node_;
	examination.fingerprint = fingerprint_;
	const std::vector<MapEdit> edits = std::exchange(edits_, {});
	is_finding_ = true;
	if (!must_copy_again_) {
		examination.attempt.copy = copy_->with_edits(followed_source_, edits);
		examination.attempt.data = followed_source_;
	}
	if (examination.attempt.copy == nullptr) {
		const std::shared_ptr<const GroundCopy> before = copy_;
		examination.attempt = copy_ground(examination.target, before.get());
	}
	is_finding_ = false;
	must_copy_again_ = false;
	if (examination.attempt.copy == nullptr) {
		change(); // The next search examines the node again.
	} else if (!is_stale_) {
		apply(examination);
	}
}

void ScatterGroundNode::notify() {
	const GroundChanges changes = std::exchange(changes_, {});
	if (changes.whole_ground || changes.areas.size() > max_areas) {
		emit_changed();
		return;
	}
	for (const Rect2 &area : changes.areas) {
		emit_area(area);
	}
}

} // namespace thicket
