#pragma once

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <vector>

namespace thicket {

/// Differences between the editor's view and the layers. Some layers are hidden, and others are displayed with trial
/// settings until a designer decides. These differences exist in the editor only. They are never stored, and have no
/// effect in a game.
class LayerPreviews {
public:
	/// Hides these layers and shows all others. Hidden layers still affect other layers.
	void set_hidden(const godot::TypedArray<ScatterLayer> &p_layers);

	/// Displays `p_stand_in` in place of a layer; null displays the layer itself.
	void set_stand_in(const godot::Ref<ScatterLayer> &p_layer, const godot::Ref<ScatterLayer> &p_stand_in);

	/// Whether each of these layers is hidden, by index; empty if none is.
	std::vector<bool> hidden(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// The layer that is displayed for a layer: itself or its stand-in.
	godot::Ref<ScatterLayer> shown(const godot::Ref<ScatterLayer> &p_layer) const;

private:
	// Stored by the engine's object IDs, so that removed layers are not kept alive.
	std::set<std::uint64_t> hidden_;
	std::map<std::uint64_t, godot::Ref<ScatterLayer>> stand_ins_;
};

} // namespace thicket
