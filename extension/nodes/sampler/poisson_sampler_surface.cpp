// Sets on surfaces in space.

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

constexpr const char *class_name = "PoissonSampler";

/// The triangles of a mesh, with an index for each corner.
struct Faces {
	std::vector<glm::dvec3> vertices;
	std::vector<std::uint32_t> indices;

	/// An index without a vertex is left to Surface::create, which refuses it.
	void append(const Array &p_arrays, const Transform3D &p_transform) {
		const auto first = static_cast<std::uint32_t>(vertices.size());
		const PackedVector3Array positions = p_arrays[SurfaceStream::positions];
		const PackedInt32Array corners = p_arrays[SurfaceStream::indices];
		const Vector3 *position = positions.ptr();
		for (int64_t index = 0; index < positions.size(); ++index) {
			vertices.push_back(to_core(p_transform.basis) * to_core(position[index]) + to_core(p_transform.origin));
		}
		const int32_t *corner = corners.ptr();
		for (int64_t index = 0; index < corners.size(); ++index) {
			indices.push_back(first + static_cast<std::uint32_t>(corner[index]));
		}
		for (int64_t index = 0; corners.size() == 0 && index < positions.size(); ++index) {
			indices.push_back(first + static_cast<std::uint32_t>(index));
		}
	}
};

Status no_triangles() {
	return Status::missing("mesh", "Pass a mesh with a surface of triangles (Mesh.PRIMITIVE_TRIANGLES)");
}

/// Only an ArrayMesh may have surfaces of other kinds.
bool has_triangles(Mesh &r_mesh, int32_t surface) {
	const StringName primitive("surface_get_primitive_type");
	return !r_mesh.has_method(primitive) ||
			static_cast<int64_t>(r_mesh.call(primitive, surface)) == SurfacePrimitive::triangles;
}

Status read(const Ref<Mesh> &p_mesh, const Transform3D &p_transform, Faces &r_faces) {
	bool found = false;
	for (int32_t surface = 0; p_mesh.is_valid() && surface < p_mesh->get_surface_count(); ++surface) {
		if (has_triangles(*p_mesh.ptr(), surface)) {
			const Array arrays = p_mesh->surface_get_arrays(surface); // May run a script of the mesh.
			if (arrays.size() > SurfaceStream::indices) {
				r_faces.append(arrays, p_transform);
				found = true;
			}
		}
	}
	return found ? Status() : no_triangles();
}

bool is_mirrored(const Transform3D &p_transform) { return glm::determinant(to_core(p_transform.basis)) < 0.0; }

} // namespace

Ref<PoissonSurfacePoints> PoissonSampler::sample_surface(
		const Ref<Mesh> &p_mesh, const Transform3D &p_transform, const AABB &p_window) {
	const Turn turn(this, "sample_surface");
	Faces faces;
	const Status status =
			turn.granted() ? guarded("mesh", 0.0, [&] { return read(p_mesh, p_transform, faces); }) : Status();
	report(class_name, status);
	if (!turn.granted() || !status.ok()) {
		return PoissonSurfacePoints::make_empty();
	}
	return sample_triangles(std::move(faces.vertices), std::move(faces.indices), p_window, is_mirrored(p_transform));
}

Ref<PoissonSurfacePoints> PoissonSampler::sample_faces(const PackedVector3Array &p_faces, const AABB &p_window) {
	const Turn turn(this, "sample_faces");
	Faces faces;
	const Status status = turn.granted() ? guarded("faces", static_cast<double>(p_faces.size()),
												   [&] {
													   const Vector3 *corner = p_faces.ptr();
													   for (int64_t index = 0; index < p_faces.size(); ++index) {
														   faces.vertices.push_back(to_core(corner[index]));
														   faces.indices.push_back(static_cast<std::uint32_t>(index));
													   }
												   })
										 : Status();
	report(class_name, status);
	if (!turn.granted() || !status.ok()) {
		return PoissonSurfacePoints::make_empty();
	}
	return sample_triangles(std::move(faces.vertices), std::move(faces.indices), p_window, false);
}

Ref<PoissonSurfacePoints> PoissonSampler::sample_triangles(
		std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices, const AABB &p_window, bool mirrored) {
	Ref<PoissonSurfacePoints> result = PoissonSurfacePoints::make_empty();
	const Status status = guarded("faces", static_cast<double>(indices.size() / 3), [&]() -> Status {
		std::shared_ptr<const Surface> surface;
		if (const Status refused = Surface::create(std::move(vertices), std::move(indices), surface); !refused.ok()) {
			return refused;
		}
		SurfaceSampler sampler;
		std::vector<SurfacePoint> points;
		const Progress progress{.cancel = &cancelled_, .report = {}};
		const Box3 window{to_core(p_window.position), to_core(p_window.position) + to_core(p_window.size)};
		const bool everywhere = p_window == AABB();
		const Status sampled = everywhere ? sampler.sample_all(set_, *surface, points, progress)
										  : sampler.sample(set_, *surface, window, points, progress);
		if (sampled.ok()) {
			result = PoissonSurfacePoints::of(points, mirrored);
		}
		return sampled;
	});
	report(class_name, status);
	return result;
}

} // namespace thicket
