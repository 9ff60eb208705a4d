#include "nodes/layer/layer_meshes.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/stripped.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Converts an LOD of a model to a MeshAppearance. A null LOD draws nothing.
MeshAppearance appearance_of(const DrawnLod *lod) {
	return lod != nullptr ? MeshAppearance{lod->mesh, {lod->shadow, lod->cast_shadow}, lod->lod_appearance}
						  : MeshAppearance();
}

/// Adds a distance, and a row with the LOD of each entry that begins there. Entries without such an
/// LOD get a null mesh. Adds nothing if no LOD begins there, or if there are already max_lods
/// distances.
void add_row(
		std::span<const std::vector<DrawnLod>> lods, double distance, LayerDrawing &r_drawing, LodSettings &r_lod) {
	std::vector<const DrawnLod *> row;
	for (const std::vector<DrawnLod> &of : lods) {
		const DrawnLod *begins = nullptr;
		for (std::size_t lod = 1; lod < of.size(); ++lod) {
			begins = of[lod].distance == distance ? &of[lod] : begins;
		}
		row.push_back(begins);
	}
	const bool changes = std::ranges::any_of(row, [](const DrawnLod *begins) { return begins != nullptr; });
	if (!changes || r_lod.lod_distances.size() == max_lods) {
		return;
	}
	r_lod.lod_distances.push_back(distance);
	std::ranges::transform(row, std::back_inserter(r_drawing.lod_meshes), appearance_of);
}

String nothing_to_draw(std::size_t entry, const Ref<PackedScene> &p_scene, const String &p_problem) {
	return vformat("ScatterLayer.meshes[%d], %s, has nothing to draw: %s.", static_cast<int64_t>(entry),
			name_of(p_scene), p_problem);
}

} // namespace

bool LayerMeshes::set_entries(const Array &p_entries) {
	const Array entries = copied(p_entries);
	if (!take(entries)) {
		return false;
	}
	entries_ = entries;
	return true;
}

bool LayerMeshes::differs() const {
	bool same = entries_.size() == static_cast<int64_t>(taken_.size());
	for (std::size_t entry = 0; same && entry < taken_.size(); ++entry) {
		same = entries_[static_cast<int64_t>(entry)].get_validated_object() == taken_[entry].resource.ptr();
	}
	return !same;
}

void LayerMeshes::restore() {
	entries_ = Array();
	for (const Entry &entry : taken_) {
		append(entries_, entry.resource.is_valid() ? Variant(entry.resource) : Variant());
	}
}

bool LayerMeshes::take(const Array &p_entries) {
	std::vector<Entry> taken;
	for (int64_t index = 0; index < p_entries.size(); ++index) {
		const Variant &entry = p_entries[index];
		Object *object = entry.get_validated_object();
		Ref<ScatterModel> model(Object::cast_to<ScatterModel>(object));
		const Ref<PackedScene> scene(Object::cast_to<PackedScene>(object));
		if (scene.is_valid()) {
			model = model_of(scene);
			if (model.is_null() && !taken_.empty()) {
				return false;
			}
		} else if (model.is_null() && entry.get_type() != Variant::NIL && Object::cast_to<Mesh>(object) == nullptr) {
			const String kind = object != nullptr ? object->get_class() : String("not a resource");
			// A Variant of type OBJECT can be null.
			if (object != nullptr || entry.get_type() != Variant::OBJECT) {
				ERR_PRINT(vformat("ScatterLayer.meshes[%d] is %s: it must be a Mesh, a PackedScene or a ScatterModel.",
						index, kind));
				return false;
			}
		}
		taken.push_back({Ref<Resource>(Object::cast_to<Resource>(object)), model});
	}
	taken_ = std::move(taken);
	return true;
}

/// Returns the existing model of a scene, or a new one. For an empty scene, prints an error and
/// returns null.
Ref<ScatterModel> LayerMeshes::model_of(const Ref<PackedScene> &p_scene) const {
	const auto known = std::ranges::find_if(taken_, [&](const Entry &entry) {
		return entry.model.is_valid() && entry.resource.ptr() == static_cast<const Resource *>(p_scene.ptr());
	});
	if (known != taken_.end()) {
		// Keep everything that has already been read.
		return known->model;
	}
	Ref<ScatterModel> model(memnew(ScatterModel));
	model->set_scene(p_scene);
	return model->get_scene().is_valid() ? model : Ref<ScatterModel>();
}

Ref<Mesh> LayerMeshes::mesh(std::size_t entry) const {
	if (taken_[entry].model.is_null()) {
		return taken_[entry].resource;
	}
	const std::vector<DrawnLod> lods = taken_[entry].model->drawn_lods();
	return lods.empty() ? Ref<Mesh>() : lods.front().mesh;
}

bool LayerMeshes::read_step() const {
	return std::ranges::any_of(
			taken_, [](const Entry &entry) { return entry.model.is_valid() && entry.model->read_step(); });
}

std::vector<Object *> LayerMeshes::sources() const {
	std::vector<Object *> result;
	for (const Entry &entry : taken_) {
		Object *source = entry.model.ptr();
		if (source == nullptr) {
			source = Ref<Mesh>(entry.resource).ptr();
		}
		if (source != nullptr) {
			result.push_back(source);
		}
	}
	return result;
}

bool LayerMeshes::reload(const PackedStringArray &p_paths) {
	bool any = false;
	const std::vector<Entry> taken = taken_; // Use a copy, because reading a scene runs its scripts.
	for (const Entry &entry : taken) {
		const Ref<PackedScene> scene = entry.model.is_valid() ? entry.model->get_scene() : Ref<PackedScene>();
		const String path = scene.is_valid() ? scene->get_path() : String();
		if (!path.is_empty() && p_paths.has(path)) {
			any = true;
			entry.model->reload();
		}
	}
	return any;
}

bool LayerMeshes::has_mesh() const {
	for (std::size_t entry = 0; entry < size(); ++entry) {
		if (mesh(entry).is_valid()) {
			return true;
		}
	}
	return false;
}

std::vector<DrawnLod> LayerMeshes::lods_of(std::size_t entry) const {
	std::vector<DrawnLod> result;
	if (taken_[entry].model.is_valid()) {
		result = taken_[entry].model->drawn_lods();
	} else if (const Ref<Mesh> only = mesh(entry); only.is_valid()) {
		result.push_back({0.0, only, {}, ScatterLod::CAST_SHADOW_LAYER, {}});
	}
	return result;
}

void LayerMeshes::draw(LayerDrawing &r_drawing, LodSettings &r_lod) const {
	std::vector<std::vector<DrawnLod>> lods;
	std::set<double> distances;
	for (std::size_t entry = 0; entry < size(); ++entry) {
		lods.push_back(lods_of(entry));
		r_drawing.meshes.push_back(appearance_of(lods.back().empty() ? nullptr : lods.back().data()));
		for (std::size_t lod = 1; lod < lods.back().size(); ++lod) {
			distances.insert(lods.back()[lod].distance);
		}
	}
	for (const double distance : distances) {
		add_row(lods, distance, r_drawing, r_lod);
	}
}

std::vector<std::vector<BodyPart>> LayerMeshes::bodies() const {
	std::vector<std::vector<BodyPart>> result(size());
	for (std::size_t entry = 0; entry < size(); ++entry) {
		if (taken_[entry].model.is_null()) {
			continue;
		}
		for (const ModelShape &shape : taken_[entry].model->model_shapes()) {
			if (std::optional<BodyPart> part = body_part(shape)) {
				result[entry].push_back(std::move(*part));
			}
		}
	}
	return result;
}

void LayerMeshes::add_problems(PackedStringArray &r_problems) const {
	if (!has_mesh()) {
		r_problems.push_back("ScatterLayer.meshes has no mesh, so the layer draws nothing. Add a mesh.");
	}
	for (std::size_t entry = 0; entry < size(); ++entry) {
		const Ref<PackedScene> scene = taken_[entry].resource;
		if (taken_[entry].model.is_null()) {
			if (scene.is_valid()) {
				r_problems.push_back(nothing_to_draw(entry, scene, empty_scene));
			}
			const Ref<Mesh> mesh = taken_[entry].resource;
			if (mesh.is_valid() && mesh->get_surface_count() == 0 && !is_stripped(mesh)) {
				r_problems.push_back(
						vformat("ScatterLayer.meshes[%d] has no surfaces, so it is not drawn. Give the mesh at "
								"least 1 surface, or choose another mesh.",
								static_cast<int64_t>(entry)));
			}
			continue;
		}
		if (!taken_[entry].model->problem().is_empty()) {
			r_problems.push_back(
					nothing_to_draw(entry, taken_[entry].model->get_scene(), taken_[entry].model->problem()));
		}
		const PackedStringArray &remarks = taken_[entry].model->remarks();
		for (const String &remark : remarks) {
			r_problems.push_back(vformat("ScatterLayer.meshes[%d], %s: %s", static_cast<int64_t>(entry),
					name_of(taken_[entry].model->get_scene()), remark));
		}
	}
}

} // namespace thicket
