#include "nodes/drawing/draw_figures.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/surface_streams.hpp"

#include <godot_cpp/classes/array_mesh.hpp>
#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/viewport.hpp>
#include <godot_cpp/core/object.hpp>

#include <array>
#include <cstddef>

using namespace godot;

namespace thicket {

namespace {

std::uint64_t triangles_of(int64_t primitive, int64_t corners) {
	switch (primitive) {
		case SurfacePrimitive::triangles: return static_cast<std::uint64_t>(corners / 3);
		case SurfacePrimitive::triangle_strip: return static_cast<std::uint64_t>(corners > 2 ? corners - 2 : 0);
		default: return 0; // Points and lines have no triangles.
	}
}

/// Counts the triangles of a mesh that is not an ArrayMesh. The surfaces of such meshes consist of
/// triangles only.
std::uint64_t triangles_of(const Mesh &mesh, int32_t surface) {
	const Array arrays = mesh.surface_get_arrays(surface);
	if (arrays.size() <= SurfaceStream::indices) {
		return 0;
	}
	const PackedInt32Array indices = arrays[SurfaceStream::indices];
	const PackedVector3Array vertices = arrays[SurfaceStream::positions];
	return triangles_of(SurfacePrimitive::triangles, indices.size() > 0 ? indices.size() : vertices.size());
}

} // namespace

const DrawCounter::MeshFigures &DrawCounter::figures_of(const Ref<Mesh> &mesh) {
	const auto entry = meshes_.find(mesh->get_instance_id());
	if (entry != meshes_.end()) {
		return entry->second;
	}
	MeshFigures &result = meshes_[mesh->get_instance_id()];
	auto *array_mesh = Object::cast_to<ArrayMesh>(mesh.ptr());
	for (int32_t surface = 0; surface < mesh->get_surface_count(); ++surface) {
		++result.surfaces;
		if (array_mesh == nullptr) {
			result.triangles += triangles_of(*mesh.ptr(), surface);
			continue;
		}
		const int32_t indices = array_mesh->surface_get_array_index_len(surface);
		const int32_t corners = indices > 0 ? indices : array_mesh->surface_get_array_len(surface);
		result.triangles +=
				triangles_of(static_cast<int64_t>(array_mesh->call("surface_get_primitive_type", surface)), corners);
	}
	return result;
}

void DrawCounter::add(const Ref<Mesh> &mesh, std::uint64_t instances, glm::dvec3 min, glm::dvec3 max) {
	if (instances == 0 || (view_ && !view_->touches(min, max))) {
		return;
	}
	const MeshFigures &mesh_figures = figures_of(mesh);
	++figures_.multimeshes;
	figures_.instances += instances;
	figures_.triangles += instances * mesh_figures.triangles;
	figures_.draw_calls += mesh_figures.surfaces;
}

ViewVolume view_of(const Camera3D &camera, const WorldFrame &frame) {
	const Vector2 size = camera.get_viewport()->get_visible_rect().size;
	const std::array<Vector2, 4> screen{Vector2(0, 0), Vector2(size.x, 0), size, Vector2(0, size.y)};
	std::array<glm::dvec3, 8> corners{};
	for (std::size_t corner = 0; corner < screen.size(); ++corner) {
		corners[corner] = to_world(camera.project_position(screen[corner], camera.get_near()), frame);
		corners[corner + screen.size()] = to_world(camera.project_position(screen[corner], camera.get_far()), frame);
	}
	return ViewVolume(corners);
}

} // namespace thicket
