#include "nodes/layer/former_drawing.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/model/scatter_model.hpp"

#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/string.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The distance in meters that replaces 0, because 0 selects a distance from the model's size.
constexpr double min_distance = 1e-3;

Ref<ScatterLod> lod_of(const Ref<Mesh> &p_mesh, double p_distance) {
	const Ref<ScatterLod> new_lod(memnew(ScatterLod));
	new_lod->set_mesh(p_mesh);
	new_lod->set_distance(p_distance);
	return new_lod;
}

/// Returns the LODs of both lists, in order.
TypedArray<ScatterLod> concatenated(const TypedArray<ScatterLod> &p_lods, const TypedArray<ScatterLod> &p_added) {
	TypedArray<ScatterLod> result;
	for (const TypedArray<ScatterLod> *lods : {&p_lods, &p_added}) {
		for (int64_t index = 0; index < lods->size(); ++index) {
			append(result, (*lods)[index]);
		}
	}
	return result;
}

/// Creates a model that is drawn like the entry, with additional LODs. Returns null if the entry
/// draws nothing. An existing model is copied, because other layers may use it without these LODs.
Ref<ScatterModel> model_with(const Variant &p_entry, const TypedArray<ScatterLod> &p_lods) {
	Object *object = p_entry.get_validated_object();
	Ref<ScatterModel> model;
	if (const Ref<ScatterModel> existing_model(Object::cast_to<ScatterModel>(object)); existing_model.is_valid()) {
		model = existing_model->duplicate();
		model->set_far_lods(concatenated(existing_model->get_far_lods(), p_lods));
	} else if (const Ref<PackedScene> scene(Object::cast_to<PackedScene>(object));
			scene.is_valid() && scene->can_instantiate()) {
		model = Ref<ScatterModel>(memnew(ScatterModel));
		model->set_scene(scene);
		model->set_far_lods(p_lods);
	} else if (const Ref<Mesh> mesh(Object::cast_to<Mesh>(object)); mesh.is_valid()) {
		model = Ref<ScatterModel>(memnew(ScatterModel));
		TypedArray<ScatterLod> lods;
		append(lods, lod_of(mesh, 0.0));
		model->set_lods(concatenated(lods, p_lods));
	}
	return model;
}

constexpr std::array visibility_properties{"visibility_range_begin", "visibility_range_begin_margin",
		"visibility_range_end", "visibility_range_end_margin", "visibility_range_fade_mode"};

} // namespace

bool FormerLods::set(const StringName &p_name, const Variant &p_value) {
	if (p_name == StringName("lod_distances")) {
		distances_ = p_value;
	} else if (p_name == StringName("lod_meshes")) {
		meshes_ = TypedArray<Mesh>(p_value);
	} else {
		return false;
	}
	const String name = "ScatterLayer." + String(p_name);
	warn_of_change(name.utf8().get_data(), "is replaced by ScatterModel.lods");
	return true;
}

bool FormerLods::is_complete(std::size_t entries) const {
	const int64_t meshes = distances_.size() * static_cast<int64_t>(entries);
	return meshes > 0 && meshes <= meshes_.size();
}

Array FormerLods::apply_to(const Array &p_entries) const {
	Array result;
	const int64_t count = p_entries.size();
	for (int64_t entry = 0; entry < count; ++entry) {
		TypedArray<ScatterLod> lods;
		for (int64_t row = 0; row < distances_.size() && (row + 1) * count <= meshes_.size(); ++row) {
			const Ref<Mesh> mesh = meshes_[row * count + entry];
			if (mesh.is_valid()) {
				append(lods, lod_of(mesh, std::max<double>(distances_.ptr()[row], min_distance)));
			}
		}
		const Ref<ScatterModel> model = lods.is_empty() ? Ref<ScatterModel>() : model_with(p_entries[entry], lods);
		append(result, model.is_valid() ? Variant(model) : p_entries[entry]);
	}
	return result;
}

bool FormerVisibility::set(const StringName &p_name, const Variant &p_value) {
	const auto is_name = [&p_name](const char *name) {
		return p_name == StringName(name);
	};
	if (std::ranges::none_of(visibility_properties, is_name)) {
		return false;
	}
	const String name = "ScatterLayer." + String(p_name);
	if (is_name("visibility_range_end")) {
		end_ = p_value;
		warn_of_change(name.utf8().get_data(), "is replaced by ScatterLayer.view_distance");
	} else {
		warn_of_removal(name.utf8().get_data(),
				"Use view_distance, lod_fade and ScatterModel.lods to decide what is drawn where");
	}
	return true;
}

double FormerVisibility::limit(double view_distance) {
	const double end = std::exchange(end_, 0.0);
	return end > 0.0 ? std::min(view_distance, end) : view_distance;
}

} // namespace thicket
