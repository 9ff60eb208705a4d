#include "nodes/ground/scatter_ground_node.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The largest float. Raster files often mark holes with the lowest float, so all floats are
/// allowed.
constexpr double max_no_ground_height = std::numeric_limits<float>::max();

} // namespace

std::shared_ptr<const Terrain> ScatterGroundNode::make_snapshot(const GroundHost &host) {
	find_ground();
	if (!problem_.is_empty() && !(problem_ == printed_problem_)) {
		ERR_PRINT(problem_);
	}
	printed_problem_ = problem_;
	is_request_missed_ = is_request_missed_ || !is_available();
	return only_on_main_thread() ? nullptr : ground_for(host);
}

String ScatterGroundNode::find_problem() {
	find_ground();
	return problem_;
}

String ScatterGroundNode::find_remark() {
	find_ground();
	return remark_;
}

bool ScatterGroundNode::has_textures() const {
	return copy_ != nullptr ? copy_->has_textures() : ground_ != nullptr && ground_->has_textures();
}

bool ScatterGroundNode::is_available() const {
	return copy_ != nullptr ? is_copy_present_
							: ground_ != nullptr && ground_->is_open() && ground_->source() != nullptr;
}

std::shared_ptr<const Terrain> ScatterGroundNode::ground_for(const GroundHost &host) const {
	const auto entry = grounds_.find(host.id);
	if (entry != grounds_.end()) {
		return entry->second;
	}
	return copy_ != nullptr ? copy_->at_offset(host.offset) : std::shared_ptr<const Terrain>(ground_);
}

Status ScatterGroundNode::sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
		const GroundNeeds &needs, std::span<Ground> r_ground) {
	// Use a copy, because a script that is called may change the property.
	const std::shared_ptr<const Terrain> ground = ground_for(host);
	if (ground == nullptr) {
		return Status::missing("ScatterGroundNode.node", "Set it to a node in the tree that has get_height()");
	}
	return ground->query(positions, needs, r_ground);
}

Status ScatterGroundNode::recheck_for(
		const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights) {
	const std::shared_ptr<ObjectGround> ground = ground_; // A called script may release `ground_`.
	const Status status = ScatterGround::recheck_for(host, positions, r_heights);
	const auto entry = grounds_.find(host.id);
	const auto *object_ground = ground != nullptr && entry != grounds_.end() && copy_ == nullptr
			? static_cast<const ObjectGround *>(entry->second.get())
			: nullptr;
	const std::shared_ptr<const Terrain> keep_alive = object_ground != nullptr ? entry->second : nullptr;
	for (std::size_t i = 0; i < positions.size() && object_ground != nullptr; ++i) {
		if (r_heights[i] && !std::isfinite(*r_heights[i]) && !object_ground->is_height_known(positions[i])) {
			r_heights[i] = std::nullopt;
		}
	}
	return status;
}

/// Finds the node and determines its kind of ground. May run the node's script, which may do
/// anything, such as changing the path, freeing the node or the host, or requesting the ground. If
/// the script has invalidated the result, the next call searches again.
void ScatterGroundNode::find_ground() {
	const Node3D *host_node = first_node();
	if (is_finding_ || host_node == nullptr || !host_node->is_inside_tree()) {
		return;
	}
	if (!is_stale_ && is_available()) {
		// The node still exists.
		return;
	}
	is_stale_ = false;
	is_finding_ = true;
	const Examination examination = find_source();
	is_finding_ = false;
	if (!is_stale_) {
		apply(examination);
	}
}

/// Examines the node: copies its ground or, if that is not possible, finds its methods.
ScatterGroundNode::Examination ScatterGroundNode::find_source() const {
	const Node3D *host_node = first_node();
	Examination examination;
	examination.target = String(node_).is_empty() ? nullptr : host_node->get_node_or_null(node_);
	if (examination.target.get_validated_object() != nullptr) {
		const std::shared_ptr<const GroundCopy> before = copy_; // Scripts may release the copy.
		examination.attempt = copy_ground(examination.target, before.get());
		if (examination.attempt.copy == nullptr) {
			examination.ground = ObjectGround::of(examination.target, limits());
		}
		examination.fingerprint = fingerprint_of(
				examination.target, examination.ground == nullptr || examination.ground->source() == nullptr);
	}
	return examination;
}

/// Applies the result of examining the node: replaces the ground and updates the messages.
void ScatterGroundNode::apply(const Examination &examination) {
	Node *target = cast_to<Node>(examination.target.get_validated_object());
	const bool in_tree = target != nullptr && target->is_inside_tree();
	const bool is_copied = examination.attempt.copy != nullptr;
	const bool is_usable =
			in_tree && (is_copied || (examination.ground != nullptr && examination.ground->source() != nullptr));
	const bool was_usable = is_available();
	problem_ = problem_of(examination, in_tree, is_usable);
	remark_ = String();
	fingerprint_ = examination.fingerprint;
	if (!is_usable || is_copied || followed_node_.get_validated_object() != target) {
		close();
	}
	is_copy_present_ = is_usable && is_copied;
	if (is_copy_present_) {
		take_copy(examination);
	} else if (is_usable) {
		use_object(examination.ground);
		if (examination.attempt.plugin != GroundPlugin::none) {
			remark_ =
					vformat("ScatterGroundNode.node: \"%s\" is like %s, but %s. Its ground is therefore not copied but "
							"queried position by position, which is slow.",
							node_, String(name_of(examination.attempt.plugin)), examination.attempt.refusal);
		}
	}
	if (is_usable && !was_usable && is_request_missed_ && !are_users_notified_) {
		changes_.whole_ground = true;
	}
	is_request_missed_ = is_request_missed_ && !is_usable;
	are_users_notified_ = false;
	const String recognized = !is_usable ? String()
			: is_copied                  ? copy_->description()
										 : vformat("%s, queried position by position", target->get_class());
	// Also watch an unusable node, because it may become usable later.
	if (target != nullptr) {
		const bool is_queried = is_usable && !is_copied;
		follow_node(target, is_queried ? ground_->source() : examination.attempt.data.get_validated_object());
	}
	set_recognized(recognized);
}

/// Returns how far the engine's origin has moved in the world, given the previous offsets of the
/// hosts. Returns nothing if the hosts have moved by different distances.
std::optional<glm::dvec3> ScatterGroundNode::shift_since(std::span<const glm::dvec3> before) const {
	if (before.size() != offsets_.size()) {
		return glm::dvec3(0.0); // Hosts were added or removed, and will request the ground.
	}
	std::optional<glm::dvec3> shift = glm::dvec3(0.0);
	for (std::size_t i = 0; i < before.size() && shift; ++i) {
		const glm::dvec3 host_shift = offsets_[i] - before[i];
		shift = i == 0 || host_shift == *shift ? std::optional(host_shift) : std::nullopt;
	}
	return shift;
}

/// Stores a new copy. Records the changes since the last copy, unless hosts have already been
/// notified that everything has changed.
void ScatterGroundNode::take_copy(const Examination &examination) {
	const std::shared_ptr<const GroundCopy> before = std::exchange(copy_, examination.attempt.copy);
	ground_ = nullptr;
	grounds_.clear();
	for (const GroundHost &host : hosts()) {
		grounds_[host.id] = copy_->at_offset(host.offset);
	}
	const std::vector<glm::dvec3> offsets = std::exchange(offsets_, host_offsets());
	if (before != nullptr && !are_users_notified_) {
		const std::optional<glm::dvec3> shift = shift_since(offsets);
		changes_.whole_ground = changes_.whole_ground || !shift;
		changes_.add(copy_->changes_since(*before, shift.value_or(glm::dvec3(0.0))));
	}
	must_copy_again_ = false;
	edits_.clear();
	const String plugin(name_of(copy_->plugin()));
	if (const String remark = copy_->remark(); !remark.is_empty()) {
		remark_ = vformat("ScatterGroundNode.node: \"%s\" (%s) %s", node_, plugin, remark);
	} else if (no_ground_enabled_ || !to_core(bounds_).empty()) {
		remark_ = vformat("ScatterGroundNode.bounds and no_ground_height have no effect: \"%s\" (%s) determines "
						  "the extent of its ground.",
				node_, plugin);
	}
}

/// Uses the ground from an object's methods. Each host receives its own copy of `ground`.
void ScatterGroundNode::use_object(const std::shared_ptr<ObjectGround> &ground) {
	copy_ = nullptr;
	ground_ = ground;
	grounds_.clear();
	std::erase_if(host_objects_, [](const HostObject &object) { return object.ground.expired(); });
	for (const GroundHost &host : hosts()) {
		const std::shared_ptr<ObjectGround> object = ground->at_offset(host.offset);
		grounds_[host.id] = object;
		host_objects_.push_back({host.id, object});
	}
}

String ScatterGroundNode::problem_of(const Examination &examination, bool in_tree, bool is_usable) const {
	if (is_usable) {
		return {};
	}
	if (String(node_).is_empty()) {
		return "ScatterGroundNode.node is missing: choose a node that has get_height(), like Terrain3D, HTerrain or "
			   "MTerrain.";
	}
	if (!in_tree) {
		return vformat(
				"ScatterGroundNode.node: no node has the path \"%s\" relative to the TerrainScatter3D. Choose a node.",
				node_);
	}
	if (examination.attempt.plugin != GroundPlugin::none) {
		return vformat("ScatterGroundNode.node: \"%s\" (%s) %s.", node_, String(name_of(examination.attempt.plugin)),
				examination.attempt.refusal);
	}
	if (is_post_grid(examination.target)) {
		return vformat(
				"ScatterGroundNode.node: \"%s\" (MTerrain) has not created its grid. Set its property create, or "
				"call create_grid().",
				node_);
	}
	if (thicket::has_method(examination.target, "get_voxel_tool")) {
		return vformat(
				"ScatterGroundNode.node: \"%s\" (%s) has voxels instead of heights. Use a ScatterGroundColliders.",
				node_, examination.target.get_validated_object()->get_class());
	}
	return vformat("ScatterGroundNode.node: \"%s\" (%s) has no get_height(), nor data with get_height(), nor "
				   "get_data() with get_interpolated_height_at(). A script must be a @tool script to work in the "
				   "editor.",
			node_, examination.target.get_validated_object()->get_class());
}

void ScatterGroundNode::set_recognized(const String &p_recognized) {
	if (!(recognized_ == p_recognized)) {
		recognized_ = p_recognized;
		notify_property_list_changed();
	}
}

// Closes all objects that hosts have received, because tiles in progress may still use replaced
// ones. Copies need not be closed.
void ScatterGroundNode::close() {
	is_copy_present_ = false;
	if (ground_ != nullptr) {
		ground_->close();
	}
	for (const HostObject &object : std::exchange(host_objects_, {})) {
		if (const std::shared_ptr<ObjectGround> ground = object.ground.lock()) {
			ground->close();
		}
	}
}

void ScatterGroundNode::set_node(const NodePath &p_node) {
	node_ = p_node;
	change();
}

NodePath ScatterGroundNode::get_node() const { return node_; }

void ScatterGroundNode::set_thread_safe(bool p_thread_safe) {
	if (thread_safe_ != p_thread_safe) {
		thread_safe_ = p_thread_safe;
		change();
	}
}

bool ScatterGroundNode::is_thread_safe() const { return thread_safe_; }

GroundLimits ScatterGroundNode::limits() const {
	GroundLimits limits;
	limits.bounds = to_core(bounds_);
	if (no_ground_enabled_) {
		limits.no_ground = static_cast<float>(no_ground_height_);
	}
	return limits;
}

void ScatterGroundNode::set_bounds(const Rect2 &p_bounds) {
	const Rect bounds = to_core(p_bounds);
	if (!bounds.finite() || !(p_bounds.size.x >= 0) || !(p_bounds.size.y >= 0)) {
		ERR_PRINT(
				vformat("ScatterGroundNode.bounds must be finite, with a size of 0 or more, got %s. Set Rect2() for a "
						"ground without bounds.",
						p_bounds));
		return;
	}
	if (!(bounds_ == p_bounds)) {
		bounds_ = p_bounds;
		change();
	}
}

Rect2 ScatterGroundNode::get_bounds() const { return bounds_; }

void ScatterGroundNode::set_no_ground_enabled(bool p_enabled) {
	if (no_ground_enabled_ != p_enabled) {
		no_ground_enabled_ = p_enabled;
		change();
	}
}

bool ScatterGroundNode::is_no_ground_enabled() const { return no_ground_enabled_; }

void ScatterGroundNode::set_no_ground_height(double p_height) {
	if (accept_number("ScatterGroundNode", "no_ground_height", p_height, -max_no_ground_height, max_no_ground_height) &&
			no_ground_height_ != p_height) {
		no_ground_height_ = p_height;
		change();
	}
}

double ScatterGroundNode::get_no_ground_height() const { return no_ground_height_; }

String ScatterGroundNode::get_recognized() const { return recognized_; }

void ScatterGroundNode::_bind_methods() {
	using Self = ScatterGroundNode;
	bind_guarded<&Self::set_node>(D_METHOD("set_node", "node"));
	bind_guarded<&Self::get_node>(D_METHOD("get_node"));
	bind_guarded<&Self::set_thread_safe>(D_METHOD("set_thread_safe", "thread_safe"));
	bind_guarded<&Self::is_thread_safe>(D_METHOD("is_thread_safe"));
	bind_guarded<&Self::set_bounds>(D_METHOD("set_bounds", "bounds"));
	bind_guarded<&Self::get_bounds>(D_METHOD("get_bounds"));
	bind_guarded<&Self::set_no_ground_enabled>(D_METHOD("set_no_ground_enabled", "enabled"));
	bind_guarded<&Self::is_no_ground_enabled>(D_METHOD("is_no_ground_enabled"));
	bind_guarded<&Self::set_no_ground_height>(D_METHOD("set_no_ground_height", "height"));
	bind_guarded<&Self::get_no_ground_height>(D_METHOD("get_no_ground_height"));
	bind_guarded<&Self::get_recognized>(D_METHOD("get_recognized"));
	bind_guarded<&Self::change>(ThreadUse::relayed, D_METHOD("_change"));
	bind_guarded<&Self::poll>(ThreadUse::main, D_METHOD("_poll"));
	bind_guarded<&Self::node_gone>(ThreadUse::relayed, D_METHOD("_node_gone"));
	bind_guarded<&Self::node_moved>(ThreadUse::relayed, D_METHOD("_node_moved", "transform"));
	bind_guarded<&Self::area_edited>(ThreadUse::relayed, D_METHOD("_area_edited", "area"));
	bind_guarded<&Self::maps_changed>(ThreadUse::relayed, D_METHOD("_maps_changed"));
	bind_guarded<&Self::map_edited>(ThreadUse::relayed, D_METHOD("_map_edited", "x", "z", "width", "depth", "channel"),
			DEFVAL(Variant()), DEFVAL(Variant()), DEFVAL(Variant()), DEFVAL(Variant()));
	bind_guarded<&Self::source_edited>(
			ThreadUse::relayed, D_METHOD("_source_edited", "first", "second"), DEFVAL(Variant()), DEFVAL(Variant()));
	ADD_PROPERTY(PropertyInfo(Variant::NODE_PATH, "node", PROPERTY_HINT_NODE_PATH_VALID_TYPES, "Node"), "set_node",
			"get_node");
	ADD_PROPERTY(PropertyInfo(Variant::STRING, "recognized", PROPERTY_HINT_NONE, "",
						 PROPERTY_USAGE_EDITOR | PROPERTY_USAGE_READ_ONLY),
			"", "get_recognized");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "thread_safe"), "set_thread_safe", "is_thread_safe");
	ADD_PROPERTY(PropertyInfo(Variant::RECT2, "bounds", PROPERTY_HINT_NONE, "suffix:m"), "set_bounds", "get_bounds");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "no_ground_enabled"), "set_no_ground_enabled", "is_no_ground_enabled");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "no_ground_height", PROPERTY_HINT_NONE, "suffix:m"),
			"set_no_ground_height", "get_no_ground_height");
}

} // namespace thicket
