#include "nodes/terrain/scatter_terrain_object.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Heights between posts, and slopes, depend on so many posts around them.
constexpr real_t posts_around = 2;

Rect2 grown(const Rect2 &rect, real_t by) {
	return {rect.position.x - by, rect.position.y - by, rect.size.x + 2 * by, rect.size.y + 2 * by};
}

} // namespace

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

// Of edits only Terrain3D (maps_edited in the editor, maps_changed) and HTerrain (the other two) tell, each in its own way.
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
		set(source, "maps_changed", "_maps_changed");
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
	const bool told_before = std::exchange(telling_, true);
	for (const glm::dvec2 corner : corners) {
		emit_terrain_changed(Rect2(to_engine(corner), p_rect.size));
	}
	telling_ = told_before;
}

void ScatterTerrainObject::area_edited(const AABB &p_area) {
	const Object *node = followed_node_.get_validated_object();
	const Variant spacing = node != nullptr ? node->get("vertex_spacing") : Variant();
	const real_t margin = is_number(spacing) ? posts_around * std::max<real_t>(spacing, 0) : 0;
	emit_area(grown({p_area.position.x, p_area.position.z, p_area.size.x, p_area.size.z}, margin));
}

/// In the editor it comes beside the area of each stroke, and would make all ground anew each time.
void ScatterTerrainObject::maps_changed() {
	if (!Engine::get_singleton()->is_editor_hint()) {
		change();
	}
}

/// HTerrain up to 1.8 tells x, z, width, depth and the channel; later ones a Rect2i, the channel and the index of the map.
void ScatterTerrainObject::map_edited(const Variant &p_x, const Variant &p_z, const Variant &p_width,
		const Variant &p_depth, const Variant &p_channel) {
	Rect2 edited;
	const bool is_rect = p_x.get_type() == Variant::RECT2I && is_number(p_z);
	if (is_rect) {
		const Rect2i rect = p_x;
		edited = {static_cast<real_t>(rect.position.x), static_cast<real_t>(rect.position.y),
				static_cast<real_t>(rect.size.x), static_cast<real_t>(rect.size.y)};
	} else if (is_number(p_x) && is_number(p_z) && is_number(p_width) && is_number(p_depth) && is_number(p_channel)) {
		edited = {p_x, p_z, p_width, p_depth};
	} else {
		change(); // Told in another way: anything may have changed.
		return;
	}
	if (ground_ != nullptr && ground_->map() != nullptr) {
		stale_ = stale_ || TerrainMap::copies(is_rect ? p_z : p_channel);
		emit_area(ground_->map()->world_rect(grown(edited, posts_around)));
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
	bind_guarded<&Self::maps_changed>(D_METHOD("_maps_changed"));
	bind_guarded<&Self::map_edited>(D_METHOD("_map_edited", "x", "z", "width", "depth", "channel"), DEFVAL(Variant()),
			DEFVAL(Variant()), DEFVAL(Variant()), DEFVAL(Variant()));
	ADD_PROPERTY(PropertyInfo(Variant::NODE_PATH, "node", PROPERTY_HINT_NODE_PATH_VALID_TYPES, "Node"), "set_node",
			"get_node");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "thread_safe"), "set_thread_safe", "is_thread_safe");
}

} // namespace thicket
