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

} // namespace

std::shared_ptr<const Terrain> ScatterTerrainMeshes::snapshot() {
	if (stale_ && host() != nullptr && host()->is_inside_tree()) {
		read();
	}
	return ground_;
}

String ScatterTerrainMeshes::problem() {
	if (String(group_).is_empty()) {
		return "ScatterTerrainMeshes.group is missing: name a group of MeshInstance3Ds that are ground.";
	}
	if (host() != nullptr && host()->is_inside_tree() && instances().empty()) {
		return vformat("ScatterTerrainMeshes.group: no MeshInstance3D in the scene belongs to \"%s\".", group_);
	}
	return {};
}

std::vector<MeshInstance3D *> ScatterTerrainMeshes::instances() const {
	std::vector<MeshInstance3D *> result;
	if (String(group_).is_empty()) {
		return result;
	}
	const Ref<World3D> world = host()->get_world_3d();
	const TypedArray<Node> nodes = host()->get_tree()->get_nodes_in_group(group_);
	for (int64_t index = 0; index < nodes.size(); ++index) {
		auto *instance = Object::cast_to<MeshInstance3D>(nodes[index].get_validated_object());
		if (instance != nullptr && instance->get_mesh().is_valid() && instance->get_world_3d() == world) {
			result.push_back(instance);
		}
	}
	return result;
}

// What is refused leaves the ground as it was.
void ScatterTerrainMeshes::read() {
	stale_ = false;
	Parts parts;
	std::vector<glm::dvec3> corners;
	for (const MeshInstance3D *instance : instances()) {
		const std::size_t first = corners.size();
		add_triangles(*instance, world_offset(), corners);
		const auto added = std::span<const glm::dvec3>(corners).subspan(first);
		if (!added.empty()) {
			parts[instance->get_instance_id()] = {digest_of(added), area_of(added)};
		}
	}
	const auto ground = std::make_shared<TriangleTerrain>();
	const Status status = ground->set(corners);
	report(class_name, status);
	if (status.ok()) {
		ground_ = ground;
		parts_ = std::move(parts);
	}
}

void ScatterTerrainMeshes::refresh() {
	if (stale_ || host() == nullptr || !host()->is_inside_tree()) {
		stale_ = true;
		return;
	}
	const Parts before = parts_;
	read();
	Rect changed = nowhere;
	for (const auto &[id, part] : before) {
		const auto now = parts_.find(id);
		if (now == parts_.end() || now->second.digest != part.digest) {
			join(changed, part.area);
		}
	}
	for (const auto &[id, part] : parts_) {
		const auto then = before.find(id);
		if (then == before.end() || then->second.digest != part.digest) {
			join(changed, part.area);
		}
	}
	if (!changed.empty()) {
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
	ClassDB::bind_method(D_METHOD("set_group", "group"), &Self::set_group);
	ClassDB::bind_method(D_METHOD("get_group"), &Self::get_group);
	ClassDB::bind_method(D_METHOD("refresh"), &Self::refresh);
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "group"), "set_group", "get_group");
}

} // namespace thicket
