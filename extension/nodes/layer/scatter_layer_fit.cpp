// This file sets properties that depend on the size and kind of a layer's meshes: trees, shrubs,
// grass or rocks.

#include "core/model/model_fit.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/resource_file.hpp"
#include "nodes/common/surface_streams.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// The minimum size in meters. Smaller meshes get the spacing and collision of this size.
constexpr double min_size = 0.05;

/// The properties that fit_to_meshes sets.
constexpr std::array fitted_properties{"radius", "density", "min_scale", "max_scale", "min_tilt_degrees",
		"max_tilt_degrees", "align_to_normal", "height_offset", "clump_size", "clump_coverage", "instance_radius",
		"instance_height", "collision_shape"};

/// The extent in meters around the vertical axis of an instance.
struct Extent {
	double radius = 0.0;
	double top = 0.0;

	void add(const Vector3 &p_corner) {
		radius = std::max(
				{radius, std::abs(static_cast<double>(p_corner.x)), std::abs(static_cast<double>(p_corner.z))});
		top = std::max(top, static_cast<double>(p_corner.y));
	}
};

/// Adds the triangles of a surface to a measure. Skips triangles with invalid indices.
void measure(const Array &p_arrays, ModelMeasure &r_measure) {
	if (p_arrays.size() <= SurfaceStream::indices) {
		return;
	}
	const PackedVector3Array positions = p_arrays[SurfaceStream::positions];
	const PackedInt32Array indices = p_arrays[SurfaceStream::indices];
	const bool is_indexed = indices.size() > 0;
	const int64_t count = is_indexed ? indices.size() : positions.size();
	const Vector3 *position = positions.ptr();
	const int32_t *index = indices.ptr();
	for (int64_t first = 0; first + 2 < count; first += 3) {
		std::array<glm::dvec3, 3> triangle{};
		bool is_valid = true;
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const int64_t element = first + static_cast<int64_t>(corner);
			const int64_t vertex = is_indexed ? index[element] : element;
			is_valid = is_valid && vertex >= 0 && vertex < positions.size();
			if (is_valid) {
				triangle[corner] = to_core(position[vertex]);
			}
		}
		if (is_valid) {
			r_measure.add(triangle);
		}
	}
}

/// Measures a mesh. On threads other than the main thread, uses only its bounding box. Reading a
/// mesh would wait for the renderer, and thus for the main thread.
ModelSize size_of(const Ref<Mesh> &p_mesh) {
	const AABB box = p_mesh->get_aabb();
	ModelMeasure model_measure(to_core(box.position), to_core(box.position + box.size));
	for (int32_t surface = 0; on_main_thread() && surface < p_mesh->get_surface_count(); ++surface) {
		measure(p_mesh->surface_get_arrays(surface), model_measure);
	}
	return model_measure.size();
}

struct WidestMesh {
	ModelSize size;
	std::optional<thicket::ModelKind> named_kind; ///< The kind that the name indicates, if any.

	thicket::ModelKind kind() const { return named_kind.value_or(kind_of(size)); }
};

std::optional<thicket::ModelKind> kind_in(const String &p_name) { return kind_named(p_name.utf8().get_data()); }

/// Returns the kind that the name of an entry indicates. Checks the names of the scene part, the
/// file and the resource, in this order.
std::optional<thicket::ModelKind> named_kind_of(const Ref<Resource> &p_entry) {
	const Ref<ScatterModel> model = p_entry;
	Ref<Resource> source = p_entry;
	if (model.is_valid() && model->get_scene().is_valid()) {
		if (const auto kind = kind_in(model->get_scene_part().get_file())) {
			return kind;
		}
		source = model->get_scene();
	}
	const auto kind = kind_in(name_of_file(source->get_path()));
	return kind ? kind : kind_in(p_entry->get_name());
}

/// Measures the mesh with the largest footprint.
std::optional<WidestMesh> measure_widest(const LayerMeshes &meshes) {
	std::optional<WidestMesh> widest;
	for (std::size_t entry = 0; entry < meshes.size(); ++entry) {
		if (const Ref<Mesh> mesh = meshes.mesh(entry); mesh.is_valid()) {
			const ModelSize size = size_of(mesh);
			if (!widest || size.footprint > widest->size.footprint) {
				widest = {.size = size, .named_kind = named_kind_of(meshes.resource(entry))};
			}
		}
	}
	return widest;
}

} // namespace

PackedStringArray ScatterLayer::get_fitted_properties() const {
	PackedStringArray names;
	for (const char *name : fitted_properties) {
		names.push_back(name);
	}
	return names;
}

ScatterLayer::ModelKind ScatterLayer::get_model_kind() {
	read_models();
	// Use a copy, because scripts of the meshes may replace the list.
	const LayerMeshes meshes = meshes_;
	const std::optional<WidestMesh> widest = measure_widest(meshes);
	return widest ? static_cast<ModelKind>(static_cast<int64_t>(widest->kind()) + KIND_TREE) : KIND_AUTOMATIC;
}

bool ScatterLayer::fit_to_meshes(ModelKind p_kind) {
	if (!accept_number(ScatterLayer::class_name, "kind", static_cast<double>(p_kind), KIND_AUTOMATIC, KIND_ROCK)) {
		return false;
	}
	read_models();
	// Use a copy, because scripts of the meshes may replace the list.
	const LayerMeshes meshes = meshes_;
	const std::optional<WidestMesh> widest = measure_widest(meshes);
	if (!widest) {
		return false;
	}
	Extent mesh_extent;
	Extent body_extent;
	for (std::size_t entry = 0; entry < meshes.size(); ++entry) {
		if (const Ref<Mesh> mesh = meshes.mesh(entry); mesh.is_valid()) {
			const AABB box = mesh->get_aabb();
			mesh_extent.add(box.position);
			mesh_extent.add(box.position + box.size);
		}
	}
	const std::vector<std::vector<BodyPart>> bodies = meshes.bodies();
	for (const std::vector<BodyPart> &parts : bodies) {
		for (const BodyPart &part : parts) {
			const glm::vec3 half_size = 0.5F * part.size;
			body_extent.add(to_engine(part.origin - half_size));
			body_extent.add(to_engine(part.origin + half_size));
			for (const glm::vec3 &corner : part.corners) {
				body_extent.add(to_engine(corner));
			}
		}
	}
	const thicket::ModelKind kind = p_kind == KIND_AUTOMATIC
			? widest->kind()
			: static_cast<thicket::ModelKind>(static_cast<int64_t>(p_kind) - KIND_TREE);
	const ModelFit fit = fit_of(kind, widest->size);
	settings_.set.radius = std::clamp(fit.radius, min_size, max_radius);
	settings_.rules.density = fit.density;
	settings_.rules.clumping.size =
			fit.clump_size > 0.0 ? std::clamp(fit.clump_size, min_clump_size, max_clump_size) : 0.0;
	settings_.rules.clumping.coverage = fit.clump_coverage;
	settings_.placement.min_scale = fit.min_scale;
	settings_.placement.max_scale = fit.max_scale;
	settings_.placement.min_tilt_degrees = 0.0;
	settings_.placement.max_tilt_degrees = fit.max_tilt_degrees;
	settings_.placement.align_to_normal = fit.align_to_normal;
	settings_.placement.height_offset = fit.height_offset;
	gameplay_.instance_radius = std::max(body_extent.radius > 0.0 ? body_extent.radius : mesh_extent.radius, min_size);
	gameplay_.instance_height = std::max(mesh_extent.top, min_size);
	if (body_extent.radius > 0.0) {
		gameplay_.collision.shape = BodyShape::model;
	}
	mark_changed();
	return true;
}

void ScatterLayer::bind_fit() {
	bind_guarded<&ScatterLayer::fit_to_meshes>(D_METHOD("fit_to_meshes", "kind"), DEFVAL(KIND_AUTOMATIC));
	bind_guarded<&ScatterLayer::get_fitted_properties>(D_METHOD("get_fitted_properties"));
	bind_guarded<&ScatterLayer::get_model_kind>(D_METHOD("get_model_kind"));
	BIND_ENUM_CONSTANT(KIND_AUTOMATIC);
	BIND_ENUM_CONSTANT(KIND_TREE);
	BIND_ENUM_CONSTANT(KIND_SHRUB);
	BIND_ENUM_CONSTANT(KIND_GRASS);
	BIND_ENUM_CONSTANT(KIND_ROCK);
}

} // namespace thicket
