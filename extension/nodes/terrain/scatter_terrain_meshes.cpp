#include "nodes/terrain/scatter_terrain_meshes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

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

namespace {

constexpr const char *class_name = "ScatterTerrainMeshes";

} // namespace

std::shared_ptr<const Terrain> ScatterTerrainMeshes::make_snapshot(const GroundHost &host) {
	if (stale_ && is_in_scene()) {
		read();
	} else if (host.node != nullptr && !worlds_.contains(host.id)) {
		const auto same = std::ranges::find_if(hosts(),
				[&](const GroundHost &other) { return other.offset == host.offset && worlds_.contains(other.id); });
		World world;
		if (same != hosts().end()) {
			// Fast path: where the origin is the same, so is the ground.
			world = worlds_[same->id];
		} else {
			read_world(host, world);
		}
		worlds_[host.id] = world;
	}
	const auto found = worlds_.find(host.id);
	return found != worlds_.end() ? found->second.ground : last_;
}

String ScatterTerrainMeshes::find_problem() {
	if (String(group_).is_empty()) {
		return "ScatterTerrainMeshes.group is missing: name a group of MeshInstance3Ds that are ground.";
	}
	const auto has_mesh = [this](const Variant &node) {
		Object *source = nullptr;
		return look()(node, source).source != 0;
	};
	if (is_in_scene() && std::ranges::none_of(members(), has_mesh)) {
		return vformat("ScatterTerrainMeshes.group: no MeshInstance3D in the scene belongs to \"%s\".", group_);
	}
	return {};
}

bool ScatterTerrainMeshes::is_in_scene() const { return first_node() != nullptr && first_node()->is_inside_tree(); }

/// All instances of the group, with meshes and without.
std::vector<Variant> ScatterTerrainMeshes::members() const {
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

GroundWatch::Look ScatterTerrainMeshes::look() const {
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

/// Watches who belongs to the group now. `changed`: those who do so since the last look are still to be read.
void ScatterTerrainMeshes::list_members(bool changed) {
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

/// False for a node that gives no ground now. A mesh may be a script's, which makes it now and may do anything.
bool ScatterTerrainMeshes::read_mesh(const Variant &p_node, GroundSight &r_sight, PackedVector3Array &r_faces) {
	Object *source = nullptr;
	r_sight = look()(p_node, source);
	const Ref<Mesh> mesh(Object::cast_to<Mesh>(source));
	if (mesh.is_null()) {
		return false;
	}
	r_sight.version = watch_.version(r_sight.source);
	++figures_.reads;
	r_faces = mesh->get_faces();
	return true;
}

/// What is refused is told, and left out.
void ScatterTerrainMeshes::read_world(const GroundHost &host, World &r_world) {
	for (const Variant &node : members()) {
		const Object *instance = node.get_validated_object();
		MeshReading reading;
		if (instance == nullptr || !is_in_scene() || !read_mesh(node, reading.sight, reading.faces)) {
			continue;
		}
		reading.id = instance->get_instance_id();
		reading.offset = host.offset;
		reading.build();
		report(class_name, reading.status);
		if (reading.part != nullptr) {
			r_world.parts[reading.id] = reading.part;
		}
	}
	close(r_world);
}

/// Makes the ground of a world from its parts. The last one stays if there is no memory.
void ScatterTerrainMeshes::close(World &r_world) {
	std::vector<TriangleParts::Part> parts;
	parts.reserve(r_world.parts.size());
	for (const auto &[id, part] : r_world.parts) {
		parts.push_back(part->ground);
	}
	const auto ground = std::make_shared<TriangleParts>();
	const Status status = ground->set(parts);
	report(class_name, status);
	if (status.ok()) {
		r_world.ground = ground;
	}
}

/// Reads the meshes for all hosts.
void ScatterTerrainMeshes::read() {
	stale_ = false;
	forget_work();
	list_members(false);
	const std::vector<GroundHost> wanted(hosts().begin(), hosts().end());
	Worlds worlds;
	for (const GroundHost &host : wanted) {
		const auto same = std::ranges::find_if(wanted,
				[&](const GroundHost &other) { return other.offset == host.offset && worlds.contains(other.id); });
		if (same != wanted.end()) {
			// Fast path: where the origin is the same, so is the ground.
			worlds[host.id] = worlds[same->id];
		} else if (is_in_scene()) {
			World world;
			read_world(host, world);
			worlds[host.id] = std::move(world);
		}
	}
	watch_.forget_changes();
	worlds_ = std::move(worlds);
	last_ = worlds_.contains(wanted.front().id) ? worlds_[wanted.front().id].ground : last_;
}

void ScatterTerrainMeshes::forget_work() {
	++run_;
	queue_.clear();
	readings_.clear();
	gone_.clear();
	builder_.cancel();
}

void ScatterTerrainMeshes::hosts_changed(bool first) {
	stale_ = stale_ || first;
	std::erase_if(worlds_, [this](const auto &world) {
		return std::ranges::find(hosts(), world.first, &GroundHost::id) == hosts().end();
	});
	if (first) {
		forget_work();
		watch_.clear();
	}
}

/// The scene may have moved along, or may not.
void ScatterTerrainMeshes::offset_changed(const GroundHost &) { watch_.touch_all(false); }

void ScatterTerrainMeshes::refresh() {
	if (stale_ || !is_in_scene()) {
		stale_ = true;
		return;
	}
	const bool was_empty = is_empty();
	const Worlds before = worlds_;
	read();
	std::vector<Rect> areas;
	for (const auto &[host, world] : before) {
		const auto now = worlds_.find(host);
		if (now != worlds_.end()) {
			add_changes(world.parts, now->second.parts, areas);
		}
	}
	tell(areas, was_empty);
}

bool ScatterTerrainMeshes::is_empty() const {
	return std::ranges::all_of(worlds_, [](const auto &world) { return world.second.parts.empty(); });
}

/// Tells where the ground is not as it was. Where it comes from nothing, or has all gone, problems come and go as well.
void ScatterTerrainMeshes::tell(const std::vector<Rect> &areas, bool was_empty) {
	const Ref<ScatterTerrain> held(this); // Who hears of changes may let go of it.
	const bool turned = was_empty != is_empty();
	for (const Rect &area : areas) {
		emit_terrain_changed(to_engine(area));
	}
	if (turned) {
		emit_changed();
	}
}

void ScatterTerrainMeshes::source_changed(int64_t p_source) { watch_.source_changed(core_id(p_source)); }

void ScatterTerrainMeshes::set_group(const StringName &p_group) {
	group_ = p_group;
	stale_ = true;
	emit_changed();
}

StringName ScatterTerrainMeshes::get_group() const { return group_; }

void ScatterTerrainMeshes::_bind_methods() {
	using Self = ScatterTerrainMeshes;
	bind_guarded<&Self::set_group>(D_METHOD("set_group", "group"));
	bind_guarded<&Self::get_group>(D_METHOD("get_group"));
	bind_guarded<&Self::refresh>(D_METHOD("refresh"));
	bind_guarded<&Self::source_changed>(D_METHOD("_source_changed", "source"));
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "group"), "set_group", "get_group");
}

} // namespace thicket
