#include "nodes/terrain/scatter_terrain_meshes.hpp"

#include "core/base/split_mix.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "ScatterTerrainMeshes";

/// Adds a mesh's triangles as they stand in the world, in which the engine's origin is at `offset`.
void add_triangles(const MeshInstance3D &instance, glm::dvec3 offset, std::vector<glm::dvec3> &r_corners) {
	const Transform3D frame = instance.get_global_transform();
	const glm::dmat3 basis = to_core(frame.basis);
	const glm::dvec3 origin = to_world(frame.origin, offset);
	const PackedVector3Array faces = instance.get_mesh()->get_faces();
	for (const Vector3 &corner : faces) {
		r_corners.push_back(origin + basis * to_core(corner));
	}
}

std::uint64_t digest_of(std::span<const glm::dvec3> corners) {
	std::uint64_t digest = corners.size();
	for (const glm::dvec3 &corner : corners) {
		for (const double coordinate : {corner.x, corner.y, corner.z}) {
			digest = split_mix(digest + split_mix_gamma) ^ std::bit_cast<std::uint64_t>(coordinate);
		}
	}
	return digest;
}

constexpr Rect nowhere{
		glm::dvec2{std::numeric_limits<double>::max()}, glm::dvec2{std::numeric_limits<double>::lowest()}};

Rect area_of(std::span<const glm::dvec3> corners) {
	Rect area = nowhere;
	for (const glm::dvec3 &corner : corners) {
		area.min = glm::min(area.min, glm::dvec2{corner.x, corner.z});
		area.max = glm::max(area.max, glm::dvec2{corner.x, corner.z});
	}
	return area;
}

void join(Rect &r_area, const Rect &other) {
	r_area.min = glm::min(r_area.min, other.min);
	r_area.max = glm::max(r_area.max, other.max);
}

/// Adds where a mesh has come, gone or changed.
void add_changes(const ScatterTerrainMeshes::Parts &before, const ScatterTerrainMeshes::Parts &now, Rect &r_changed) {
	for (const auto &[id, part] : before) {
		const auto same = now.find(id);
		if (same == now.end() || same->second.digest != part.digest) {
			join(r_changed, part.area);
		}
	}
}

} // namespace

std::shared_ptr<const Terrain> ScatterTerrainMeshes::make_snapshot(const GroundHost &host) {
	if (stale_ && first_node() != nullptr && first_node()->is_inside_tree()) {
		read();
	} else if (host.node != nullptr && !worlds_.contains(host.id)) {
		add_world(host, worlds_);
	}
	const auto found = worlds_.find(host.id);
	const std::shared_ptr<const World> &world = found != worlds_.end() ? found->second : last_;
	return world != nullptr ? world->ground : nullptr;
}

String ScatterTerrainMeshes::find_problem() {
	if (String(group_).is_empty()) {
		return "ScatterTerrainMeshes.group is missing: name a group of MeshInstance3Ds that are ground.";
	}
	if (first_node() != nullptr && first_node()->is_inside_tree() && instances().empty()) {
		return vformat("ScatterTerrainMeshes.group: no MeshInstance3D in the scene belongs to \"%s\".", group_);
	}
	return {};
}

std::vector<Variant> ScatterTerrainMeshes::instances() const {
	std::vector<Variant> result;
	if (String(group_).is_empty()) {
		return result;
	}
	const Ref<World3D> world = first_node()->get_world_3d();
	const TypedArray<Node> nodes = first_node()->get_tree()->get_nodes_in_group(group_);
	for (int64_t index = 0; index < nodes.size(); ++index) {
		auto *instance = Object::cast_to<MeshInstance3D>(nodes[index].get_validated_object());
		if (instance != nullptr && instance->get_mesh().is_valid() && instance->get_world_3d() == world) {
			result.push_back(nodes[index]);
		}
	}
	return result;
}

/// False, with an error, for what is refused. A mesh may be a script's, which makes it now and may free instances.
bool ScatterTerrainMeshes::read_world(glm::dvec3 offset, World &r_world) const {
	std::vector<glm::dvec3> corners;
	for (const Variant &node : instances()) {
		const auto *instance = Object::cast_to<MeshInstance3D>(node.get_validated_object());
		if (instance == nullptr || !instance->is_inside_tree()) {
			continue;
		}
		const std::uint64_t id = instance->get_instance_id();
		const std::size_t first = corners.size();
		add_triangles(*instance, offset, corners);
		const auto added = std::span<const glm::dvec3>(corners).subspan(first);
		if (!added.empty()) {
			r_world.parts[id] = {digest_of(added), area_of(added)};
		}
	}
	const auto ground = std::make_shared<TriangleTerrain>();
	const Status status = ground->set(corners);
	report(class_name, status);
	r_world.ground = ground;
	return status.ok();
}

/// Adds the world of a host: that of another host whose offset is the same, or one that is read now. False for what is refused.
bool ScatterTerrainMeshes::add_world(const GroundHost &host, Worlds &r_worlds) {
	for (const GroundHost &other : hosts()) {
		if (other.offset == host.offset && r_worlds.contains(other.id)) {
			r_worlds[host.id] = r_worlds[other.id];
			return true;
		}
	}
	const auto made = std::make_shared<World>();
	if (!read_world(host.offset, *made)) {
		return false;
	}
	r_worlds[host.id] = made;
	return true;
}

/// Reads the meshes for all hosts. What is refused leaves the ground as it was.
void ScatterTerrainMeshes::read() {
	stale_ = false;
	const std::vector<GroundHost> wanted(hosts().begin(), hosts().end());
	Worlds worlds;
	for (const GroundHost &host : wanted) {
		if (!add_world(host, worlds)) {
			return;
		}
	}
	last_ = worlds[wanted.front().id];
	worlds_ = std::move(worlds);
}

void ScatterTerrainMeshes::hosts_changed(bool first) {
	stale_ = stale_ || first;
	std::erase_if(worlds_, [this](const auto &world) {
		return std::ranges::find(hosts(), world.first, &GroundHost::id) == hosts().end();
	});
}

void ScatterTerrainMeshes::refresh() {
	if (stale_ || first_node() == nullptr || !first_node()->is_inside_tree()) {
		stale_ = true;
		return;
	}
	const Ref<ScatterTerrain> held(this); // Who hears of changes may let go of it.
	const auto before = worlds_;
	read();
	std::vector<Rect> told;
	for (const auto &[host, world] : before) {
		const auto now = worlds_.find(host);
		Rect changed = nowhere;
		if (now != worlds_.end()) {
			add_changes(world->parts, now->second->parts, changed);
			add_changes(now->second->parts, world->parts, changed);
		}
		const auto is_same = [&changed](const Rect &other) {
			return other.min == changed.min && other.max == changed.max;
		};
		if (!changed.empty() && std::ranges::none_of(told, is_same)) {
			told.push_back(changed);
		}
	}
	for (const Rect &changed : told) {
		emit_terrain_changed(to_engine(changed));
	}
}

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
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "group"), "set_group", "get_group");
}

} // namespace thicket
