#include "nodes/ground/scatter_ground_meshes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/stripped.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

std::shared_ptr<const Terrain> ScatterGroundMeshes::make_snapshot(const GroundHost &host) {
	const auto world = worlds_.find(host.id);
	return world != worlds_.end() ? world->second.ground : last_ground_;
}

String ScatterGroundMeshes::find_problem() {
	if (String(group_).is_empty()) {
		return "ScatterGroundMeshes.group is empty: set it to the group of the nodes that are ground.";
	}
	const auto has_mesh = [this](const Variant &node) {
		Object *source = nullptr;
		return state_reader()(node, source).source != 0;
	};
	if (is_in_scene() && std::ranges::none_of(members_.list(first_node(), group_), has_mesh)) {
		return vformat("ScatterGroundMeshes.group: the group \"%s\" has no MeshInstance3D, StaticBody3D, GridMap or "
					   "CSG node with a shape in this scene. Add nodes to the group.",
				group_);
	}
	return {};
}

/// Describes the first rejected instance and adds the number of others.
String ScatterGroundMeshes::find_remark() {
	if (refusals_.empty()) {
		return {};
	}
	const auto other_count = static_cast<std::int64_t>(refusals_.size()) - 1;
	return refusals_.begin()->second +
			(other_count > 0 ? vformat(" (And %d other nodes of the group.)", other_count) : String());
}

String ScatterGroundMeshes::find_export_problem() {
	const auto has_stripped_mesh = [this](const Variant &node) {
		Object *source = nullptr;
		state_reader()(node, source);
		return is_stripped(Ref<Resource>(Object::cast_to<Mesh>(source)));
	};
	if (is_in_scene() && std::ranges::any_of(members_.list(first_node(), group_), has_stripped_mesh)) {
		return stripped_problem(
				vformat("A mesh in the group \"%s\" of ScatterGroundMeshes", group_), "it is not ground");
	}
	return {};
}

bool ScatterGroundMeshes::is_in_scene() const { return first_node() != nullptr && first_node()->is_inside_tree(); }

GroundWatch::ReadState ScatterGroundMeshes::state_reader() {
	// For a single host with local coordinates, only movement relative to the host matters. Other
	// hosts would see such nodes move.
	const GroundHost &host = hosts().front();
	const Node3D *space = hosts().size() == 1 && host.local ? host.node : nullptr;
	const GroundMembers::MemberFilter filter{group_, host.node->get_world_3d(), space};
	return [this, filter](const Variant &p_node, Object *&r_source) {
		return members_.read_state(p_node, filter, r_source);
	};
}

/// Watches the current members of the group and unwatches former ones. If `as_changed` is true, marks
/// new members as changed.
void ScatterGroundMeshes::list_members(bool as_changed) {
	std::set<std::uint64_t> member_ids;
	for (const Variant &node : members_.list(first_node(), group_)) {
		const std::uint64_t id = node.get_validated_object()->get_instance_id();
		member_ids.insert(id);
		watch_.add(id, node, state_reader(), as_changed);
	}
	for (const std::uint64_t id : watch_.ids()) {
		if (!member_ids.contains(id)) {
			record_removal(id);
			watch_.remove(id);
		}
	}
	listed_count_ = members_.count(first_node(), group_);
}

/// Records where a node that has left the group was ground.
void ScatterGroundMeshes::record_removal(std::uint64_t id) {
	for (const auto &[host, world] : worlds_) {
		if (const auto mesh = world.meshes->find(id); mesh != world.meshes->end()) {
			removed_areas_[host].push_back(area_of(*mesh->second));
		}
	}
}

std::vector<Rect> ScatterGroundMeshes::take_removed_areas(std::uint64_t host) {
	const auto areas = removed_areas_.extract(host);
	return areas.empty() ? std::vector<Rect>() : std::move(areas.mapped());
}

void ScatterGroundMeshes::hosts_changed(bool first) {
	is_stale_ = is_stale_ || first;
	std::erase_if(worlds_, [this](const auto &world) {
		return std::ranges::find(hosts(), world.first, &GroundHost::id) == hosts().end();
	});
	std::erase_if(removed_areas_, [this](const auto &entry) { return !worlds_.contains(entry.first); });
	if (first) {
		forget_work();
		watch_.clear();
		refusals_.clear();
	}
}

/// Re-checks all nodes, because the scene may or may not have moved with the origin.
void ScatterGroundMeshes::offset_changed(const GroundHost &) { watch_.mark_all_changed(false); }

void ScatterGroundMeshes::refresh() {
	if (is_stale_ || !is_in_scene()) {
		is_stale_ = true;
		return;
	}
	const Ref<ScatterGround> keep_alive(this);
	forget_work();
	watch_.mark_all_changed(true);
	start_reading();
	build(true);
}

bool ScatterGroundMeshes::is_empty() const {
	return std::ranges::all_of(worlds_, [](const auto &world) { return world.second.meshes->empty(); });
}

/// Emits signals for areas of changed ground. If the ground has become empty or is no longer empty,
/// also emits `changed`, because that affects warnings.
void ScatterGroundMeshes::notify(const std::vector<Rect> &areas, bool was_empty) {
	const Ref<ScatterGround> keep_alive(this); // A signal handler may release the ground.
	const bool emptiness_changed = was_empty != is_empty();
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
	if (emptiness_changed) {
		emit_changed();
	}
}

void ScatterGroundMeshes::forget_work() {
	queue_.clear();
	reader_.cancel();
	readings_.clear();
	removed_ids_.clear();
	builder_.cancel();
}

void ScatterGroundMeshes::source_changed(int64_t p_source) { watch_.source_changed(core_id(p_source)); }

void ScatterGroundMeshes::set_group(const StringName &p_group) {
	group_ = p_group;
	is_stale_ = true;
	emit_changed();
}

StringName ScatterGroundMeshes::get_group() const { return group_; }

/// The shell of a mesh that was read for another planet is unknown, so it is treated as unlimited.
GroundShell ScatterGroundMeshes::shell(std::uint64_t host, const Planet &planet) const {
	GroundShell result;
	const auto world = worlds_.find(host);
	if (world == worlds_.end()) {
		return result;
	}
	for (const auto &[id, mesh] : *world->second.meshes) {
		result.add(mesh->planet == planet ? mesh->shell : GroundShell::everywhere());
	}
	return result;
}

void ScatterGroundMeshes::set_planet_radius(double p_radius) {
	if (accept_number(class_name, "planet_radius", p_radius, 0.0, max_planet_radius) &&
			std::exchange(planet_.radius, p_radius) != p_radius) {
		is_stale_ = true; // The shell of each mesh must be recomputed.
		emit_changed();
	}
}

void ScatterGroundMeshes::set_planet_center(const Vector3 &p_center) {
	const glm::dvec3 center = to_core(p_center);
	for (const auto &[property, value] : {std::pair("planet_center.x", center.x),
				 std::pair("planet_center.y", center.y), std::pair("planet_center.z", center.z)}) {
		if (!accept_number(class_name, property, value, -height_limit, height_limit)) {
			return;
		}
	}
	if (std::exchange(planet_.center, center) != center) {
		is_stale_ = true;
		emit_changed();
	}
}

Vector3 ScatterGroundMeshes::get_planet_center() const { return to_engine(planet_.center); }

void ScatterGroundMeshes::_bind_methods() {
	using Self = ScatterGroundMeshes;
	bind_guarded<&Self::set_group>(D_METHOD("set_group", "group"));
	bind_guarded<&Self::get_group>(D_METHOD("get_group"));
	bind_guarded<&Self::refresh>(D_METHOD("refresh"));
	bind_guarded<&Self::source_changed>(ThreadUse::relayed, D_METHOD("_source_changed", "source"));
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "group"), "set_group", "get_group");
	bind_guarded<&Self::set_planet_radius>(D_METHOD("set_planet_radius", "radius"));
	bind_guarded<&Self::get_planet_radius>(D_METHOD("get_planet_radius"));
	bind_guarded<&Self::set_planet_center>(D_METHOD("set_planet_center", "center"));
	bind_guarded<&Self::get_planet_center>(D_METHOD("get_planet_center"));
	ADD_GROUP("Planet", "planet_");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "planet_radius", PROPERTY_HINT_RANGE, "0,10000,0.1,or_greater,suffix:m"),
			"set_planet_radius", "get_planet_radius");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR3, "planet_center", PROPERTY_HINT_NONE, "suffix:m"), "set_planet_center",
			"get_planet_center");
}

} // namespace thicket
