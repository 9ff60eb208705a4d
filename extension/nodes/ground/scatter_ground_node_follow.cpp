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
constexpr real_t posts_around = 2;

/// The maximum number of areas to report. If there are more, the ground is reported as changed
/// everywhere.
constexpr std::size_t max_areas = 256;

Rect2 grown(const Rect2 &rect, real_t by) {
	return {rect.position.x - by, rect.position.y - by, rect.size.x + 2 * by, rect.size.y + 2 * by};
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
	const auto set = [this, p_connect](Object *object, const StringName &signal, const StringName &method) {
		if (object != nullptr && object->has_signal(signal)) {
			watch(object, signal, this, method, p_connect);
		}
	};
	Object *node = followed_node_.get_validated_object();
	Object *source = followed_source_.get_validated_object();
	set(node, "tree_exiting", "_node_gone");
	set(node, "tree_entered", "_change");
	const bool is_queried = !present_ && is_available();
	const bool map = is_queried && ground_->map() != nullptr;
	if (!is_queried || map || !p_connect) {
		set(source, "region_changed", "_map_edited");
	}
	// The node is copied, or may be copied once it has all required data.
	if (!is_queried || !p_connect) {
		for (const char *const signal : {"transform_changed", "material_changed"}) {
			set(node, signal, "_source_edited");
		}
		for (const char *const signal : {"maps_edited", "maps_changed", "region_map_changed", "height_maps_changed",
					 "control_maps_changed", "resolution_changed", "map_added", "map_removed", "map_changed"}) {
			set(source, signal, "_source_edited");
		}
	}
	if (map || !p_connect) {
		set(node, "transform_changed", "_node_moved");
	}
	if ((is_queried && !map) || !p_connect) {
		set(source, "maps_edited", "_area_edited");
		set(source, "maps_changed", "_maps_changed");
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
	stale_ = true;
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
	edited_ = true;
	for (const Given &given : std::vector(given_)) {
		const std::shared_ptr<ObjectGround> ground = given.host == host.id ? given.ground.lock() : nullptr;
		if (ground != nullptr) {
			ground->set_offset(host.offset);
		}
	}
}

void ScatterGroundNode::change() {
	stale_ = true;
	notified_ = true;
	changes_ = {};
	emit_changed();
}

void ScatterGroundNode::node_gone() {
	close();
	change();
}

void ScatterGroundNode::node_moved(const Transform3D &) { change(); }

/// Emits `ground_changed` for an area in the engine's space, once for each world position that it
/// has among the hosts.
void ScatterGroundNode::emit_area(const Rect2 &p_rect) {
	std::vector<glm::dvec2> corners;
	for (const GroundHost &host : hosts()) {
		const glm::dvec2 corner = to_core(p_rect.position) + glm::dvec2(host.offset.x, host.offset.z);
		if (std::ranges::find(corners, corner) == corners.end()) {
			corners.push_back(corner);
		}
	}
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	const bool emitting_before = std::exchange(emitting_, true);
	for (const glm::dvec2 corner : corners) {
		emit_ground_changed(Rect2(to_engine(corner), p_rect.size));
	}
	emitting_ = emitting_before;
}

void ScatterGroundNode::area_edited(const AABB &p_area) {
	const Object *node = followed_node_.get_validated_object();
	const Variant spacing = node != nullptr ? node->get("vertex_spacing") : Variant();
	const real_t margin = is_number(spacing) ? posts_around * std::max<real_t>(spacing, 0) : 0;
	emit_area(grown({p_area.position.x, p_area.position.z, p_area.size.x, p_area.size.z}, margin));
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
	Rect2i edited;
	const bool is_rect = p_x.get_type() == Variant::RECT2I && is_number(p_z);
	if (is_rect) {
		edited = p_x;
	} else if (is_number(p_x) && is_number(p_z) && is_number(p_width) && is_number(p_depth) && is_number(p_channel)) {
		edited = {Vector2i(static_cast<int32_t>(p_x), static_cast<int32_t>(p_z)),
				Vector2i(static_cast<int32_t>(p_width), static_cast<int32_t>(p_depth))};
	} else {
		change(); // Unknown arguments, so anything may have changed.
		return;
	}
	const std::int64_t channel = is_rect ? p_z : p_channel;
	if (present_) {
		edited_ = edited_ || edits_.size() >= max_areas;
		// The older arguments do not include the index of the map.
		edits_.push_back({channel, is_rect && is_number(p_width) ? static_cast<std::int64_t>(p_width) : -1, edited});
	} else if (!is_available()) {
		edited_ = true;
	} else if (ground_->map() != nullptr) {
		stale_ = stale_ || TerrainMap::copies(channel);
		const Rect2 rect(static_cast<real_t>(edited.position.x), static_cast<real_t>(edited.position.y),
				static_cast<real_t>(edited.size.x), static_cast<real_t>(edited.size.y));
		emit_area(ground_->map()->world_rect(grown(rect, posts_around)));
	}
}

/// Records that a copied ground may have changed. `poll` copies it again and compares the copies,
/// at most once per frame.
void ScatterGroundNode::source_edited(const Variant &, const Variant &) { edited_ = true; }

/// Detects nodes that were added, removed or replaced without a signal, and processes reported
/// changes. Called every frame.
void ScatterGroundNode::poll() {
	const Ref<ScatterGround> keep_alive(this);
	const Node3D *from = first_node();
	if (finding_ || stale_ || from == nullptr || !from->is_inside_tree()) {
		return;
	}
	finding_ = true;
	const Variant target(String(node_).is_empty() ? nullptr : from->get_node_or_null(node_));
	const GroundFingerprint fingerprint = fingerprint_of(target, copy_ != nullptr || !is_available());
	finding_ = false;
	if (stale_) {
		return;
	}
	if (!(fingerprint == fingerprint_)) {
		fingerprint_ = fingerprint;
		change();
		return;
	}
	if (present_ && !edited_) {
		const std::shared_ptr<const GroundCopy> copy = copy_; // A called script may release `copy_`.
		finding_ = true;
		edited_ = copy->is_outdated(target) || edited_;
		finding_ = false;
	}
	if (present_ && (edited_ || !edits_.empty())) {
		copy_again();
	} else if (std::exchange(edited_, false) && !is_available()) {
		change(); // The node may now have the data that it lacked before.
		return;
	}
	notify();
}

void ScatterGroundNode::copy_again() {
	Found found;
	found.target = followed_node_;
	found.fingerprint = fingerprint_;
	const std::vector<MapEdit> edits = std::exchange(edits_, {});
	finding_ = true;
	if (!edited_) {
		found.attempt.copy = copy_->with_edits(followed_source_, edits);
		found.attempt.data = followed_source_;
	}
	if (found.attempt.copy == nullptr) {
		const std::shared_ptr<const GroundCopy> before = copy_;
		found.attempt = copy_ground(found.target, before.get());
	}
	finding_ = false;
	edited_ = false;
	if (found.attempt.copy == nullptr) {
		change(); // The next search examines the node again.
	} else if (!stale_) {
		take(found);
	}
}

void ScatterGroundNode::notify() {
	const GroundChanges changes = std::exchange(changes_, {});
	if (changes.everywhere || changes.areas.size() > max_areas) {
		emit_changed();
		return;
	}
	for (const Rect2 &area : changes.areas) {
		emit_area(area);
	}
}

} // namespace thicket
