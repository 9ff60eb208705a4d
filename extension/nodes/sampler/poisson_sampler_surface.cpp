// This file contains the methods of PoissonSampler that sample surfaces in 3D space.

#include "core/base/guard.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/surface_streams.hpp"
#include "nodes/sampler/poisson_sampler.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>

#include <glm/matrix.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

Status no_triangles() {
	return Status::missing("mesh", "Pass a mesh with a surface of triangles (Mesh.PRIMITIVE_TRIANGLES)");
}

/// Returns true if a surface consists of triangles. Only ArrayMesh can have surfaces of other
/// primitives.
bool has_triangles(Mesh &r_mesh, int32_t surface) {
	const StringName primitive("surface_get_primitive_type");
	return !r_mesh.has_method(primitive) ||
			static_cast<int64_t>(r_mesh.call(primitive, surface)) == SurfacePrimitive::triangles;
}

} // namespace

/// Indexed triangles.
struct PoissonSampler::Faces {
	std::vector<glm::dvec3> vertices;
	std::vector<std::uint32_t> indices;

	/// Appends the triangles, transformed. Does not check indices, because Surface::create rejects
	/// those that are out of range.
	void append(
			const PackedVector3Array &p_positions, const PackedInt32Array &p_corners, const Transform3D &p_transform) {
		const auto first = static_cast<std::uint32_t>(vertices.size());
		const glm::dmat3 basis = to_core(p_transform.basis);
		const Vector3 *position = p_positions.ptr();
		for (int64_t index = 0; index < p_positions.size(); ++index) {
			vertices.push_back(basis * to_core(position[index]) + to_core(p_transform.origin));
		}
		const int32_t *corner = p_corners.ptr();
		const bool is_indexed = p_corners.size() > 0;
		const int64_t count = is_indexed ? p_corners.size() : p_positions.size();
		for (int64_t index = 0; index < count; ++index) {
			indices.push_back(first + static_cast<std::uint32_t>(is_indexed ? corner[index] : index));
		}
	}
};

Status PoissonSampler::read_mesh(const Ref<Mesh> &p_mesh, const Transform3D &p_transform, Faces &r_faces) {
	bool has_surface = false;
	for (int32_t surface = 0; p_mesh.is_valid() && surface < p_mesh->get_surface_count(); ++surface) {
		if (has_triangles(*p_mesh.ptr(), surface)) {
			const Array arrays = p_mesh->surface_get_arrays(surface); // May run the mesh's script.
			if (arrays.size() > SurfaceStream::indices) {
				r_faces.append(arrays[SurfaceStream::positions], arrays[SurfaceStream::indices], p_transform);
				has_surface = true;
			}
		}
	}
	return has_surface ? Status() : no_triangles();
}

Ref<PoissonSurfacePoints> PoissonSampler::sample_surface(
		const Ref<Mesh> &p_mesh, const Transform3D &p_transform, const AABB &p_window) {
	const CallScope scope(this, "sample_surface");
	const bool is_mirrored = glm::determinant(to_core(p_transform.basis)) < 0.0;
	return sample_triangles(scope, "mesh", p_window, is_mirrored,
			[&](Faces &r_faces) { return read_mesh(p_mesh, p_transform, r_faces); });
}

Ref<PoissonSurfacePoints> PoissonSampler::sample_faces(const PackedVector3Array &p_faces, const AABB &p_window) {
	const CallScope scope(this, "sample_faces");
	return sample_triangles(scope, "faces", p_window, false, [&p_faces](Faces &r_faces) {
		r_faces.append(p_faces, PackedInt32Array(), Transform3D());
		return Status();
	});
}

Ref<PoissonSurfacePoints> PoissonSampler::sample_triangles(const CallScope &p_scope, const char *p_property,
		const AABB &p_window, bool is_mirrored, const std::function<Status(Faces &r_faces)> &read) {
	Ref<PoissonSurfacePoints> result = PoissonSurfacePoints::make_empty();
	if (!p_scope.is_granted()) {
		return result;
	}
	Faces faces;
	Status status = guarded(p_property, 0.0, [&] { return read(faces); });
	if (status.ok()) {
		status = guarded("faces", static_cast<double>(faces.indices.size() / 3), [&]() -> Status {
			std::shared_ptr<const Surface> surface;
			const Status creation_status =
					Surface::create(std::move(faces.vertices), std::move(faces.indices), surface);
			if (!creation_status.ok()) {
				return creation_status;
			}
			SurfaceSampler sampler;
			std::vector<SurfacePoint> points;
			const Progress progress{.cancel = &is_cancelled_, .report = {}};
			const glm::dvec3 corner = to_core(p_window.position);
			const Status sample_status = p_window == AABB()
					? sampler.sample_all(set_, *surface, points, progress)
					: sampler.sample(set_, *surface, {corner, corner + to_core(p_window.size)}, points, progress);
			if (sample_status.ok()) {
				result = PoissonSurfacePoints::of(points, is_mirrored);
			}
			return sample_status;
		});
	}
	report(class_name, status);
	return result;
}

} // namespace thicket
