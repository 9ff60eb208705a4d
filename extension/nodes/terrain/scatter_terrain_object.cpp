#include "nodes/terrain/scatter_terrain_object.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

std::shared_ptr<const Terrain> ScatterTerrainObject::make_snapshot(const GroundHost &host) {
	find();
	if (!problem_.is_empty() && !(problem_ == reported_)) {
		ERR_PRINT(problem_);
	}
	reported_ = problem_;
	return thread_safe_ ? ground_for(host) : nullptr;
}

String ScatterTerrainObject::find_problem() {
	find();
	return problem_;
}

bool ScatterTerrainObject::is_available() const {
	return ground_ != nullptr && ground_->is_open() && ground_->source() != nullptr;
}

std::shared_ptr<const ObjectGround> ScatterTerrainObject::ground_for(const GroundHost &host) const {
	const auto found = grounds_.find(host.id);
	return found != grounds_.end() ? found->second : ground_;
}

Status ScatterTerrainObject::sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
		std::span<const std::int32_t> textures, std::span<Ground> r_ground) {
	const std::shared_ptr<const ObjectGround> ground = ground_for(host); // Whoever is asked may change the property.
	if (ground == nullptr) {
		return {ErrorCode::missing, "ScatterTerrainObject.node", 0.0};
	}
	const Status status = ground->sample(positions, r_ground);
	return status.ok() && !textures.empty() ? ground->weigh(positions, textures, r_ground) : status;
}

/// Looks for the node, and for what may be asked of it. That may run its script, which may do anything: change the path, free
/// the node or the host, or ask for the ground. Then the next call looks again.
void ScatterTerrainObject::find() {
	const Node3D *from = first_node();
	if (finding_ || from == nullptr || !from->is_inside_tree() || (!stale_ && is_available())) {
		return;
	}
	stale_ = false;
	const Variant target(String(node_).is_empty() ? nullptr : from->get_node_or_null(node_));
	std::shared_ptr<ObjectGround> found;
	if (target.get_validated_object() != nullptr) {
		finding_ = true;
		found = ObjectGround::of(target);
		finding_ = false;
	}
	if (!stale_) {
		take(target, found);
	}
}

void ScatterTerrainObject::take(const Variant &p_target, const std::shared_ptr<ObjectGround> &found) {
	Node *target = cast_to<Node>(p_target.get_validated_object());
	const bool in_tree = target != nullptr && target->is_inside_tree();
	const bool usable = found != nullptr && in_tree && found->source() != nullptr;
	problem_ = problem_of(in_tree ? target : nullptr, usable);
	if (!usable || followed_node_.get_validated_object() != target) {
		close();
	}
	if (usable) {
		ground_ = found;
		grounds_.clear();
		std::erase_if(given_, [](const Given &given) { return given.ground.expired(); });
		for (const GroundHost &host : hosts()) {
			const std::shared_ptr<ObjectGround> ground = found->at_offset(host.offset);
			grounds_[host.id] = ground;
			given_.push_back({host.id, ground});
		}
	}
	if (target != nullptr) {
		follow(target); // Also one that is of no use: it may be, once it is back.
	}
}

String ScatterTerrainObject::problem_of(const Node *p_target, bool p_usable) const {
	if (p_usable) {
		return {};
	}
	if (String(node_).is_empty()) {
		return "ScatterTerrainObject.node is missing: choose a node that has get_height(), like Terrain3D or HTerrain.";
	}
	if (p_target == nullptr) {
		return vformat("ScatterTerrainObject.node: there is no node at \"%s\" from the TerrainScatter3D.", node_);
	}
	return vformat("ScatterTerrainObject.node: \"%s\" (%s) has no get_height(), nor data with get_height(), nor "
				   "get_data() with get_interpolated_height_at(). A script must be a @tool script to be asked in the "
				   "editor.",
			node_, p_target->get_class());
}

void ScatterTerrainObject::follow(Node *p_target) {
	unfollow();
	followed_node_ = Variant(p_target);
	followed_source_ = is_available() ? Variant(ground_->source()) : Variant();
	connect_signals(true);
}

void ScatterTerrainObject::unfollow() {
	connect_signals(false);
	followed_node_ = Variant();
	followed_source_ = Variant();
}

// Of edits only Terrain3D (maps_edited) and HTerrain (the other two) tell, each in its own way.
void ScatterTerrainObject::connect_signals(bool p_connect) {
	const auto set = [this, p_connect](Object *object, const StringName &signal, const StringName &method) {
		if (object != nullptr && object->has_signal(signal)) {
			watch(object, signal, this, method, p_connect);
		}
	};
	Object *node = followed_node_.get_validated_object();
	Object *source = followed_source_.get_validated_object();
	set(node, "tree_exiting", "_node_gone");
	set(node, "tree_entered", "_change");
	const bool map = ground_ != nullptr && ground_->map() != nullptr;
	if (map || !p_connect) {
		set(node, "transform_changed", "_node_moved");
		set(source, "region_changed", "_map_edited");
	}
	if (!map || !p_connect) {
		set(source, "maps_edited", "_area_edited");
	}
}

// Tiles under way may hold one that has been replaced.
void ScatterTerrainObject::close() {
	if (ground_ != nullptr) {
		ground_->close();
	}
	for (const Given &given : std::exchange(given_, {})) {
		if (const std::shared_ptr<ObjectGround> ground = given.ground.lock()) {
			ground->close();
		}
	}
}

void ScatterTerrainObject::offset_changed(const GroundHost &host) {
	for (const Given &given : std::vector(given_)) {
		const std::shared_ptr<ObjectGround> ground = given.host == host.id ? given.ground.lock() : nullptr;
		if (ground != nullptr) {
			ground->set_offset(host.offset);
		}
	}
}

void ScatterTerrainObject::hosts_changed(bool) {
	stale_ = true;
	if (hosts().empty()) {
		unfollow();
		close(); // Nobody tells any more when the node goes.
	}
}

void ScatterTerrainObject::change() {
	stale_ = true;
	emit_changed();
}

void ScatterTerrainObject::node_gone() {
	close();
	change();
}

void ScatterTerrainObject::node_moved(const Transform3D &) { change(); }

/// An area of the engine's space was edited. It may be elsewhere in the world for each host.
void ScatterTerrainObject::emit_area(const Rect2 &p_rect) {
	std::vector<glm::dvec2> corners;
	for (const GroundHost &host : hosts()) {
		const glm::dvec2 corner = to_core(p_rect.position) + glm::dvec2(host.offset.x, host.offset.z);
		if (std::ranges::find(corners, corner) == corners.end()) {
			corners.push_back(corner);
		}
	}
	const Ref<ScatterTerrain> held(this); // Who hears of it may let go of it.
	for (const glm::dvec2 corner : corners) {
		emit_terrain_changed(Rect2(to_engine(corner), p_rect.size));
	}
}

void ScatterTerrainObject::area_edited(const AABB &p_area) {
	emit_area(Rect2(p_area.position.x, p_area.position.z, p_area.size.x, p_area.size.z));
}

void ScatterTerrainObject::map_edited(int64_t p_x, int64_t p_z, int64_t p_width, int64_t p_depth, int64_t p_channel) {
	if (ground_ != nullptr && ground_->map() != nullptr) {
		// Heights between posts and slopes depend on the posts around them.
		constexpr real_t margin = 2;
		const Rect2 part(static_cast<real_t>(p_x) - margin, static_cast<real_t>(p_z) - margin,
				static_cast<real_t>(p_width) + 2 * margin, static_cast<real_t>(p_depth) + 2 * margin);
		stale_ = stale_ || TerrainMap::copies(p_channel);
		emit_area(ground_->map()->world_rect(part));
	}
}

void ScatterTerrainObject::set_node(const NodePath &p_node) {
	node_ = p_node;
	change();
}

NodePath ScatterTerrainObject::get_node() const { return node_; }

void ScatterTerrainObject::set_thread_safe(bool p_thread_safe) {
	if (thread_safe_ != p_thread_safe) {
		thread_safe_ = p_thread_safe;
		change();
	}
}

bool ScatterTerrainObject::is_thread_safe() const { return thread_safe_; }

void ScatterTerrainObject::_bind_methods() {
	using Self = ScatterTerrainObject;
	bind_guarded<&Self::set_node>(D_METHOD("set_node", "node"));
	bind_guarded<&Self::get_node>(D_METHOD("get_node"));
	bind_guarded<&Self::set_thread_safe>(D_METHOD("set_thread_safe", "thread_safe"));
	bind_guarded<&Self::is_thread_safe>(D_METHOD("is_thread_safe"));
	bind_guarded<&Self::change>(D_METHOD("_change"));
	bind_guarded<&Self::node_gone>(D_METHOD("_node_gone"));
	bind_guarded<&Self::node_moved>(D_METHOD("_node_moved", "transform"));
	bind_guarded<&Self::area_edited>(D_METHOD("_area_edited", "area"));
	bind_guarded<&Self::map_edited>(D_METHOD("_map_edited", "x", "z", "width", "depth", "channel"));
	ADD_PROPERTY(PropertyInfo(Variant::NODE_PATH, "node", PROPERTY_HINT_NODE_PATH_VALID_TYPES, "Node"), "set_node",
			"get_node");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "thread_safe"), "set_thread_safe", "is_thread_safe");
}

} // namespace thicket
