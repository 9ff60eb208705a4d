// This file contains ScatterLayer.surface_layers, the layers on whose models a layer grows.

#include "nodes/common/engine_arrays.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <vector>

using namespace godot;

namespace thicket {

void ScatterLayer::set_surface_layers(const Array &p_layers) {
	if (p_layers.size() > static_cast<int64_t>(max_hosts)) {
		report(ScatterLayer::class_name,
				Status::wrong_size("surface_layers", p_layers.size(), at_most(max_hosts, "entries")));
		return;
	}
	Array stored_references; // A copy, because scripts share arrays by reference.
	std::vector<LayerReference> core_references;
	for (int64_t i = 0; i < p_layers.size(); ++i) {
		const Variant reference = accept_reference("ScatterLayer.surface_layers", p_layers[i], this);
		if (reference.get_type() == Variant::NIL) {
			return;
		}
		append(stored_references, reference);
		core_references.push_back(core_reference(reference));
	}
	surface_layers_ = stored_references;
	links_.surface_layers = std::move(core_references);
	mark_changed();
}

Array ScatterLayer::get_surface_layers() const { return current_references(surface_layers_); }

void ScatterLayer::change_surface_layers(const ReferenceChange &change) {
	const auto update = [&](const Variant &p_stored) {
		return changed_reference(change, "ScatterLayer.surface_layers", p_stored, this);
	};
	if (const auto updated = changed_references(surface_layers_, update)) {
		set_surface_layers(*updated);
	}
}

void ScatterLayer::add_host_problems(PackedStringArray &r_problems) const {
	if (links_.surface_layers.empty()) {
		return;
	}
	if (!settings_.set.on_surface) {
		r_problems.push_back(
				"ScatterLayer.surface_layers has no effect while on_surfaces is off: enable on_surfaces, or clear "
				"surface_layers.");
	}
	for (const LayerReference &reference : links_.surface_layers) {
		if (reference.empty()) {
			r_problems.push_back("ScatterLayer.surface_layers has an entry without a layer's name. Remove the entry.");
		}
	}
}

void ScatterLayer::bind_hosts() {
	bind_guarded<&ScatterLayer::set_surface_layers>(D_METHOD("set_surface_layers", "layers"));
	bind_guarded<&ScatterLayer::get_surface_layers>(D_METHOD("get_surface_layers"));
	add_layer_property(PropertyUse::placement, PropertyInfo(Variant::ARRAY, "surface_layers"), "set_surface_layers",
			"get_surface_layers");
}

} // namespace thicket
