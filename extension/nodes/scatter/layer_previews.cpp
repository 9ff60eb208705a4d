#include "nodes/scatter/layer_previews.hpp"

#include <godot_cpp/core/object.hpp>

using namespace godot;

namespace thicket {

void LayerPreviews::set_hidden(const TypedArray<ScatterLayer> &p_layers) {
	hidden_layer_ids_.clear();
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = p_layers[index]; layer.is_valid()) {
			hidden_layer_ids_.insert(layer->get_instance_id());
		}
	}
}

void LayerPreviews::set_stand_in(const Ref<ScatterLayer> &p_layer, const Ref<ScatterLayer> &p_stand_in) {
	if (p_layer.is_null()) {
		return;
	}
	if (p_stand_in.is_null() || p_stand_in == p_layer) {
		stand_ins_.erase(p_layer->get_instance_id());
	} else {
		stand_ins_[p_layer->get_instance_id()] = p_stand_in;
	}
}

std::vector<bool> LayerPreviews::hidden_flags(const TypedArray<ScatterLayer> &p_layers) const {
	std::vector<bool> result;
	if (hidden_layer_ids_.empty()) {
		return result;
	}
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		result.push_back(layer.is_valid() && hidden_layer_ids_.count(layer->get_instance_id()) > 0);
	}
	return result;
}

Ref<ScatterLayer> LayerPreviews::displayed_layer(const Ref<ScatterLayer> &p_layer) const {
	const auto stand_in = p_layer.is_valid() ? stand_ins_.find(p_layer->get_instance_id()) : stand_ins_.end();
	return stand_in != stand_ins_.end() ? stand_in->second : p_layer;
}

} // namespace thicket
