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
	for (const std::vector<DrawnLod> &entry_lods : lods) {
		const DrawnLod *entry_lod = nullptr; // The LOD that begins at the distance.
		for (std::size_t lod = 1; lod < entry_lods.size(); ++lod) {
			entry_lod = entry_lods[lod].distance == distance ? &entry_lods[lod] : entry_lod;
		}
		row.push_back(entry_lod);
	}
	const bool has_lods = std::ranges::any_of(row, [](const DrawnLod *entry_lod) { return entry_lod != nullptr; });
	if (!has_lods || r_lod.lod_distances.size() == max_lods) {
		return;
	}
	r_lod.lod_distances.push_back(distance);
	std::ranges::transform(row, std::back_inserter(r_drawing.lod_meshes), appearance_of);
}

String empty_entry_problem(std::size_t entry, const Ref<PackedScene> &p_scene, const String &p_problem) {
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
	bool is_same = entries_.size() == static_cast<int64_t>(accepted_entries_.size());
	for (std::size_t entry = 0; is_same && entry < accepted_entries_.size(); ++entry) {
		is_same =
				entries_[static_cast<int64_t>(entry)].get_validated_object() == accepted_entries_[entry].resource.ptr();
	}
	return !is_same;
}

void LayerMeshes::restore() {
	entries_ = Array();
	for (const Entry &entry : accepted_entries_) {
		append(entries_, entry.resource.is_valid() ? Variant(entry.resource) : Variant());
	}
}

bool LayerMeshes::take(const Array &p_entries) {
	std::vector<Entry> new_entries;
	for (int64_t index = 0; index < p_entries.size(); ++index) {
		const Variant &entry = p_entries[index];
		Object *object = entry.get_validated_object();
		Ref<ScatterModel> model(Object::cast_to<ScatterModel>(object));
		const Ref<PackedScene> scene(Object::cast_to<PackedScene>(object));
		if (scene.is_valid()) {
			model = model_of(scene);
			if (model.is_null() && !accepted_entries_.empty()) {
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
		new_entries.push_back({Ref<Resource>(Object::cast_to<Resource>(object)), model});
	}
	accepted_entries_ = std::move(new_entries);
	return true;
}

/// Returns the existing model of a scene, or a new one. For an empty scene, prints an error and
/// returns null.
Ref<ScatterModel> LayerMeshes::model_of(const Ref<PackedScene> &p_scene) const {
	const auto existing = std::ranges::find_if(accepted_entries_, [&](const Entry &entry) {
		return entry.model.is_valid() && entry.resource.ptr() == static_cast<const Resource *>(p_scene.ptr());
	});
	if (existing != accepted_entries_.end()) {
		// Keep everything that has already been read.
		return existing->model;
	}
	Ref<ScatterModel> model(memnew(ScatterModel));
	model->set_scene(p_scene);
	return model->get_scene().is_valid() ? model : Ref<ScatterModel>();
}

Ref<Mesh> LayerMeshes::mesh(std::size_t entry) const {
	if (accepted_entries_[entry].model.is_null()) {
		return accepted_entries_[entry].resource;
	}
	const std::vector<DrawnLod> lods = accepted_entries_[entry].model->drawn_lods();
	return lods.empty() ? Ref<Mesh>() : lods.front().mesh;
}

bool LayerMeshes::read_step() const {
	return std::ranges::any_of(
			accepted_entries_, [](const Entry &entry) { return entry.model.is_valid() && entry.model->read_step(); });
}

std::vector<Object *> LayerMeshes::sources() const {
	std::vector<Object *> result;
	for (const Entry &entry : accepted_entries_) {
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
	bool any_reloaded = false;
	const std::vector<Entry> entries = accepted_entries_; // Use a copy, because reading a scene runs its scripts.
	for (const Entry &entry : entries) {
		const Ref<PackedScene> scene = entry.model.is_valid() ? entry.model->get_scene() : Ref<PackedScene>();
		const String path = scene.is_valid() ? scene->get_path() : String();
		if (!path.is_empty() && p_paths.has(path)) {
			any_reloaded = true;
			entry.model->reload();
		}
	}
	return any_reloaded;
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
	if (accepted_entries_[entry].model.is_valid()) {
		result = accepted_entries_[entry].model->drawn_lods();
	} else if (const Ref<Mesh> single_mesh = mesh(entry); single_mesh.is_valid()) {
		result.push_back({0.0, single_mesh, {}, ScatterLod::CAST_SHADOW_LAYER, {}});
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
		if (accepted_entries_[entry].model.is_null()) {
			continue;
		}
		for (const ModelShape &shape : accepted_entries_[entry].model->model_shapes()) {
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
		const Ref<PackedScene> scene = accepted_entries_[entry].resource;
		if (accepted_entries_[entry].model.is_null()) {
			if (scene.is_valid()) {
				r_problems.push_back(empty_entry_problem(entry, scene, empty_scene));
			}
			const Ref<Mesh> mesh = accepted_entries_[entry].resource;
			if (mesh.is_valid() && mesh->get_surface_count() == 0 && !is_stripped(mesh)) {
				r_problems.push_back(
						vformat("ScatterLayer.meshes[%d] has no surfaces, so it is not drawn. Give the mesh at "
								"least 1 surface, or choose another mesh.",
								static_cast<int64_t>(entry)));
			}
			continue;
		}
		if (!accepted_entries_[entry].model->problem().is_empty()) {
			r_problems.push_back(empty_entry_problem(
					entry, accepted_entries_[entry].model->get_scene(), accepted_entries_[entry].model->problem()));
		}
		const PackedStringArray &remarks = accepted_entries_[entry].model->remarks();
		for (const String &remark : remarks) {
			r_problems.push_back(vformat("ScatterLayer.meshes[%d], %s: %s", static_cast<int64_t>(entry),
					name_of(accepted_entries_[entry].model->get_scene()), remark));
		}
	}
}

} // namespace thicket
