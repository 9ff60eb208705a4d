#include "nodes/ground/scatter_ground_meshes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/stripped.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <algorithm>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

std::shared_ptr<const Terrain> ScatterGroundMeshes::make_snapshot(const GroundHost &host) {
	const auto found = worlds_.find(host.id);
	return found != worlds_.end() ? found->second.ground : last_;
}

String ScatterGroundMeshes::find_problem() {
	if (String(group_).is_empty()) {
		return "ScatterGroundMeshes.group is missing: name a group of MeshInstance3Ds that are ground.";
	}
	const auto has_mesh = [this](const Variant &node) {
		Object *source = nullptr;
		return look()(node, source).source != 0;
	};
	if (is_in_scene() && std::ranges::none_of(members(), has_mesh)) {
		return vformat("ScatterGroundMeshes.group: no MeshInstance3D in the scene belongs to \"%s\".", group_);
	}
	return {};
}

/// The first refused instance, and the number of others.
String ScatterGroundMeshes::find_remark() {
	if (refusals_.empty()) {
		return {};
	}
	const auto others = static_cast<std::int64_t>(refusals_.size()) - 1;
	return refusals_.begin()->second + (others > 0 ? vformat(" (And %d other nodes of the group.)", others) : String());
}

String ScatterGroundMeshes::find_stripped() {
	const auto has_stripped_mesh = [this](const Variant &node) {
		Object *source = nullptr;
		look()(node, source);
		return is_stripped(Ref<Resource>(Object::cast_to<Mesh>(source)));
	};
	if (is_in_scene() && std::ranges::any_of(members(), has_stripped_mesh)) {
		return stripped_problem(
				vformat("A mesh in the group \"%s\" of ScatterGroundMeshes", group_), "it is no ground");
	}
	return {};
}

bool ScatterGroundMeshes::is_in_scene() const { return first_node() != nullptr && first_node()->is_inside_tree(); }

/// All instances of the group, with or without meshes.
std::vector<Variant> ScatterGroundMeshes::members() const {
	std::vector<Variant> result;
	if (String(group_).is_empty()) {
		return result;
	}
	const TypedArray<Node> nodes = first_node()->get_tree()->get_nodes_in_group(group_);
	for (int64_t index = 0; index < nodes.size(); ++index) {
		if (Object::cast_to<MeshInstance3D>(nodes[index].get_validated_object()) != nullptr) {
			result.push_back(nodes[index]);
		}
	}
	return result;
}

GroundWatch::Look ScatterGroundMeshes::look() const {
	return [group = group_, world = first_node()->get_world_3d()](const Variant &p_node, Object *&r_source) {
		const auto *instance = Object::cast_to<MeshInstance3D>(p_node.get_validated_object());
		if (instance == nullptr || !instance->is_inside_tree() || !instance->is_in_group(group)) {
			return GroundSight{};
		}
		const Ref<Mesh> mesh = instance->get_mesh();
		if (mesh.is_null() || !(instance->get_world_3d() == world)) {
			return GroundSight{};
		}
		r_source = mesh.ptr();
		return GroundSight{instance->get_global_transform(), mesh->get_instance_id()};
	};
}

/// Watches the current members of the group. If `changed` is true, members that were added since the last check count
/// as changed.
void ScatterGroundMeshes::list_members(bool changed) {
	listed_ = first_node()->get_tree()->get_node_count_in_group(group_);
	std::set<std::uint64_t> found;
	for (const Variant &node : members()) {
		const std::uint64_t id = node.get_validated_object()->get_instance_id();
		found.insert(id);
		watch_.add(id, node, look(), changed);
	}
	for (const std::uint64_t id : watch_.ids()) {
		if (!found.contains(id)) {
			watch_.remove(id);
		}
	}
}

void ScatterGroundMeshes::hosts_changed(bool first) {
	stale_ = stale_ || first;
	std::erase_if(worlds_, [this](const auto &world) {
		return std::ranges::find(hosts(), world.first, &GroundHost::id) == hosts().end();
	});
	if (first) {
		forget_work();
		watch_.clear();
		refusals_.clear();
	}
}

/// The scene may or may not have moved along.
void ScatterGroundMeshes::offset_changed(const GroundHost &) { watch_.touch_all(false); }

void ScatterGroundMeshes::refresh() {
	if (stale_ || !is_in_scene()) {
		stale_ = true;
		return;
	}
	const Ref<ScatterGround> held(this);
	forget_work();
	watch_.touch_all(true);
	begin();
	build(true);
}

bool ScatterGroundMeshes::is_empty() const {
	return std::ranges::all_of(worlds_, [](const auto &world) { return world.second.parts->empty(); });
}

/// Reports the areas of changed ground. If the ground was empty or is now empty, the problems change as well.
void ScatterGroundMeshes::tell(const std::vector<Rect> &areas, bool was_empty) {
	const Ref<ScatterGround> held(this); // A handler of changes may release it.
	const bool turned = was_empty != is_empty();
	for (const Rect &area : areas) {
		emit_ground_changed(to_engine(area));
	}
	if (turned) {
		emit_changed();
	}
}

void ScatterGroundMeshes::forget_work() {
	queue_.clear();
	reader_.cancel();
	readings_.clear();
	gone_.clear();
	builder_.cancel();
}

void ScatterGroundMeshes::source_changed(int64_t p_source) { watch_.source_changed(core_id(p_source)); }

void ScatterGroundMeshes::set_group(const StringName &p_group) {
	group_ = p_group;
	stale_ = true;
	emit_changed();
}

StringName ScatterGroundMeshes::get_group() const { return group_; }

void ScatterGroundMeshes::_bind_methods() {
	using Self = ScatterGroundMeshes;
	bind_guarded<&Self::set_group>(D_METHOD("set_group", "group"));
	bind_guarded<&Self::get_group>(D_METHOD("get_group"));
	bind_guarded<&Self::refresh>(D_METHOD("refresh"));
	bind_guarded<&Self::source_changed>(ThreadUse::relayed, D_METHOD("_source_changed", "source"));
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "group"), "set_group", "get_group");
}

} // namespace thicket
