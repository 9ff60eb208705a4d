// This file contains the properties of ScatterLayer for its meshes, scenes and models, and for how
// often each of them is used.

#include "nodes/common/convert.hpp"
#include "nodes/common/resource_file.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Returns true if the number of entries of a property is allowed. Otherwise prints an error.
bool accept_count(const char *property, int64_t p_count, const char *remedy) {
	const bool is_allowed = p_count <= static_cast<int64_t>(max_meshes);
	if (!is_allowed) {
		report(ScatterLayer::class_name,
				Status::out_of_range(property, p_count, at_most(max_meshes, "entries"), remedy));
	}
	return is_allowed;
}

bool accept_count(const Array &p_meshes) { return accept_count("meshes", p_meshes.size(), "Divide them among layers"); }

} // namespace

void ScatterLayer::set_meshes(const Array &p_meshes) {
	LayerMeshes new_meshes = meshes_;
	if (accept_count(p_meshes) && new_meshes.set_entries(p_meshes)) {
		replace_meshes(new_meshes);
		convert_former_lods(false);
		mark_changed();
	}
}

void ScatterLayer::replace_meshes(const LayerMeshes &p_meshes) {
	watch_meshes(false);
	meshes_ = p_meshes;
	watch_meshes(true);
}

/// Converts the LODs that release 0.2 saved, if they are complete. If `p_include_incomplete` is
/// true, also converts incomplete ones.
void ScatterLayer::convert_former_lods(bool p_include_incomplete) {
	if (former_lods_.is_complete(meshes_.size()) || (p_include_incomplete && !former_lods_.empty())) {
		LayerMeshes new_meshes = meshes_;
		if (new_meshes.set_entries(std::exchange(former_lods_, {}).apply_to(meshes_.entries()))) {
			replace_meshes(new_meshes);
		}
	}
}

void ScatterLayer::take_mesh_changes() {
	watch_meshes(false);
	const bool is_accepted = accept_count(meshes_.entries()) && meshes_.take_changes();
	if (!is_accepted) {
		meshes_.restore();
	}
	watch_meshes(true);
	if (is_accepted) {
		mark_changed();
	}
}

/// Watches all meshes and models. Tiles of a larger mesh need larger bounds, and layers may grow on
/// its triangles.
void ScatterLayer::watch_meshes(bool p_watch) {
	for (Object *source : meshes_.sources()) {
		watch(source, "changed", this, "_meshes_changed", p_watch);
	}
}

void ScatterLayer::meshes_changed() {
	++mesh_version_;
	emit_changed();
}

Array ScatterLayer::get_meshes() const { return meshes_.entries(); }

String ScatterLayer::mesh_name(std::size_t mesh) const {
	const Ref<Resource> entry = mesh < meshes_.size() ? meshes_.resource(mesh) : Ref<Resource>();
	const Ref<ScatterModel> model = entry;
	Ref<Resource> file = entry;
	String name = entry.is_valid() ? entry->get_name() : String();
	if (name.is_empty() && model.is_valid()) {
		name = model->get_scene_part().get_file();
		file = model->get_scene();
	}
	if (name.is_empty() && file.is_valid()) {
		name = name_of_file(file->get_path());
	}
	return name.is_empty() ? vformat("Entry %d", static_cast<int64_t>(mesh)) : name;
}

bool ScatterLayer::read_step() {
	// Use a copy, because scripts in the scenes may replace the list.
	const LayerMeshes meshes = meshes_;
	return meshes.read_step();
}

/// Reads all models immediately. On threads other than the main thread, reads nothing; only the
/// parts that have already been read are then available.
void ScatterLayer::read_models() {
	convert_former_lods(true);
	if (meshes_.differs()) {
		take_mesh_changes();
	}
	while (on_main_thread() && read_step()) {}
}

void ScatterLayer::reload_scenes(const PackedStringArray &p_paths) {
	LayerMeshes meshes = meshes_; // Use a copy, because scripts in the scenes may replace the list.
	meshes.reload(p_paths);
}

void ScatterLayer::set_mesh_weights(const PackedFloat32Array &p_weights) {
	for (const float weight : p_weights) {
		if (!accept_number(ScatterLayer::class_name, "mesh_weights", weight, 0.0, 1e6)) {
			return;
		}
	}
	mesh_weights_ = p_weights;
	mark_changed();
}

PackedFloat32Array ScatterLayer::get_mesh_weights() const { return mesh_weights_; }

void ScatterLayer::set_mesh_density_expressions(const PackedStringArray &p_texts) {
	if (!accept_count("mesh_density_expressions", p_texts.size(), "Remove the entries beyond those of meshes")) {
		return;
	}
	std::vector<SharedExpression> expressions = mesh_expressions_;
	expressions.resize(static_cast<std::size_t>(p_texts.size()));
	for (std::size_t mesh = 0; mesh < expressions.size(); ++mesh) {
		const std::string property = "ScatterLayer.mesh_density_expressions[" + std::to_string(mesh) + "]";
		if (!compile_text(property, p_texts[static_cast<int64_t>(mesh)], expressions[mesh])) {
			return;
		}
	}
	if (expressions != mesh_expressions_) {
		mesh_expressions_ = std::move(expressions);
		mark_changed();
	}
}

PackedStringArray ScatterLayer::get_mesh_density_expressions() const {
	PackedStringArray texts;
	for (const SharedExpression &expression : mesh_expressions_) {
		texts.push_back(text_of(expression));
	}
	return texts;
}

void ScatterLayer::bind_meshes() {
	bind_guarded<&ScatterLayer::set_meshes>(D_METHOD("set_meshes", "meshes"));
	bind_guarded<&ScatterLayer::get_meshes>(D_METHOD("get_meshes"));
	// A hint string can name several element classes, but a typed array only one, so scripts see an
	// untyped array.
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::ARRAY, "meshes", PROPERTY_HINT_TYPE_STRING,
					vformat("%d/%d:Mesh,PackedScene,ScatterModel", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_meshes", "get_meshes");
	bind_guarded<&ScatterLayer::set_mesh_weights>(D_METHOD("set_mesh_weights", "weights"));
	bind_guarded<&ScatterLayer::get_mesh_weights>(D_METHOD("get_mesh_weights"));
	add_layer_property(PropertyUse::placement, PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "mesh_weights"),
			"set_mesh_weights", "get_mesh_weights");
	bind_guarded<&ScatterLayer::set_mesh_density_expressions>(D_METHOD("set_mesh_density_expressions", "texts"));
	bind_guarded<&ScatterLayer::get_mesh_density_expressions>(D_METHOD("get_mesh_density_expressions"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::PACKED_STRING_ARRAY, "mesh_density_expressions", PROPERTY_HINT_TYPE_STRING,
					vformat("%d/%d:smoothstep(900, 1200, height)", Variant::STRING, PROPERTY_HINT_PLACEHOLDER_TEXT)),
			"set_mesh_density_expressions", "get_mesh_density_expressions");
	bind_guarded<&ScatterLayer::meshes_changed>(ThreadUse::relayed, D_METHOD("_meshes_changed"));
	bind_guarded<&ScatterLayer::reload_scenes>(D_METHOD("reload_scenes", "paths"));
	bind_fit();
}

} // namespace thicket
