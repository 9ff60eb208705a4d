#include "nodes/ground/voxel_volumes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

bool is_meshed(const Variant &p_volume, const AABB &column) {
	// The method of VoxelLodTerrain also needs the LOD index. It is 0, because only the blocks of
	// the finest LOD have bodies with any settings.
	const bool has_lods = has_method(p_volume, "get_lod_count");
	const Variant result = has_lods ? result_of(p_volume, "is_area_meshed", {column, 0})
									: result_of(p_volume, "is_area_meshed", {column});
	return result.get_type() != Variant::BOOL || static_cast<bool>(result);
}

/// Returns the bounds of a volume's voxels. If the volume has no method for them, the bounds are
/// larger than any world.
AABB bounds_of(const Variant &p_volume) {
	constexpr real_t extent = 1e9F;
	for (const char *const method : {"get_bounds", "get_voxel_bounds"}) {
		const Variant bounds = has_method(p_volume, method) ? result_of(p_volume, method) : Variant();
		if (bounds.get_type() == Variant::AABB) {
			return bounds;
		}
	}
	return {Vector3(-extent, -extent, -extent), Vector3(2 * extent, 2 * extent, 2 * extent)};
}

} // namespace

bool VoxelVolumes::is_volume(const Node *p_node) {
	return p_node != nullptr && p_node->has_method("get_voxel_tool") && p_node->has_method("is_area_meshed");
}

void VoxelVolumes::add(Node *p_node) {
	std::erase_if(volumes_, [p_node](const Variant &volume) {
		const Object *object = volume.get_validated_object();
		return object == nullptr || object == p_node;
	});
	volumes_.emplace_back(p_node);
}

bool VoxelVolumes::is_loaded(glm::dvec2 position, double bottom, double top) const {
	for (const Variant &volume : std::vector(volumes_)) { // A copy: scripts may add and remove volumes.
		const auto *node = Object::cast_to<Node3D>(volume.get_validated_object());
		if (node == nullptr || !node->is_inside_tree()) {
			continue;
		}
		const Transform3D frame = node->get_global_transform();
		const glm::dmat3 to_voxels = glm::inverse(to_core(frame.basis));
		const glm::dvec3 from = to_voxels * (glm::dvec3(position.x, bottom, position.y) - to_core(frame.origin));
		const glm::dvec3 to = to_voxels * (glm::dvec3(position.x, top, position.y) - to_core(frame.origin));
		const AABB bounds = bounds_of(volume);
		const glm::dvec3 first = to_core(bounds.position);
		const glm::dvec3 last = first + to_core(bounds.size);
		const double low = std::max(std::min(from.y, to.y), first.y);
		const double high = std::min(std::max(from.y, to.y), last.y);
		if (from.x >= first.x && from.x < last.x && from.z >= first.z && from.z < last.z && low < high &&
				!is_meshed(volume,
						{to_engine(glm::dvec3(from.x, low, from.z)), to_engine(glm::dvec3(1.0, high - low, 1.0))})) {
			return false;
		}
	}
	return true;
}

} // namespace thicket
