// This file checks the resources that TerrainScatter3D needs for drawing: models that must be read,
// and resources that an export has stripped.

#include "nodes/common/editor.hpp"
#include "nodes/scatter/scatter_problems.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/classes/os.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <utility>

using namespace godot;

namespace thicket {

/// Reads the models of the layers until `deadline`, but at least part of one. Returns false if some
/// are still unread or if a script in a model has freed the node.
bool TerrainScatter3D::read_models(std::chrono::steady_clock::time_point deadline) const {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const TypedArray<ScatterLayer> layers = all_layers();
	for (int64_t index = 0; index < layers.size(); ++index) {
		const Ref<ScatterLayer> original = layers[index];
		const Ref<ScatterLayer> layer = in_editor() ? previews_.displayed_layer(original) : original;
		while (layer.is_valid() && layer->read_step()) {
			if (!gameplay->alive() || std::chrono::steady_clock::now() >= deadline) {
				return false;
			}
		}
	}
	return true;
}

/// Reads models if there is a ground. Returns true if all models have been read. Without a ground
/// nothing is drawn, so no model is needed.
bool TerrainScatter3D::models_are_read(std::chrono::steady_clock::time_point deadline) const {
	return ground_.is_null() || read_models(deadline);
}

/// Prints a warning about stripped resources on a dedicated server, which has no other way to
/// display it.
void TerrainScatter3D::warn_of_stripped() {
	static const bool on_server = OS::get_singleton()->has_feature("dedicated_server");
	if (!on_server || warned_of_stripped_) {
		return;
	}
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const PackedStringArray problems = stripped_problems(all_layers(), ground_, biomes_.ptr());
	if (gameplay->alive() && problems.size() > 0) {
		warned_of_stripped_ = true;
		WARN_PRINT(vformat("TerrainScatter3D \"%s\": %s (One of %d such problems; get_problems() returns all of them.)",
				get_name(), problems[0], problems.size()));
	}
}

/// Updates the warning about layers with too many instances.
void TerrainScatter3D::check_load() {
	PackedStringArray problems;
	instance_load_.add_problems(layer_list_.snapshots(), problems);
	if (std::exchange(load_problems_, problems.size()) != problems.size()) {
		update_configuration_warnings();
	}
}

} // namespace thicket
