#pragma once

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace thicket {

/// Temporary overrides for how the editor displays layers: some are hidden, others are replaced by
/// a copy with trial settings. The overrides are never saved and have no effect in a game.
class LayerPreviews {
public:
	/// Hides these layers and shows all others. Hidden layers still influence where other layers
	/// are placed.
	void set_hidden(const godot::TypedArray<ScatterLayer> &p_layers);

	/// Displays `p_stand_in` instead of a layer; null restores the layer.
	void set_stand_in(const godot::Ref<ScatterLayer> &p_layer, const godot::Ref<ScatterLayer> &p_stand_in);

	/// Returns whether each of these layers is hidden, by index. Returns an empty list if no layer
	/// is hidden.
	std::vector<bool> hidden_flags(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// Returns the layer to display: the stand-in if there is one, otherwise the layer itself.
	godot::Ref<ScatterLayer> displayed_layer(const godot::Ref<ScatterLayer> &p_layer) const;

private:
	// These members contain instance IDs, so that removed layers are not kept alive.
	std::set<std::uint64_t> hidden_layer_ids_;
	std::map<std::uint64_t, godot::Ref<ScatterLayer>> stand_ins_;
};

} // namespace thicket
