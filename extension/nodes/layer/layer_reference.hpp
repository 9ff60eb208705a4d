#pragma once

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// Finds the layer that a script or a scene means, by the ScatterLayer itself, its name (a String or StringName) or its
/// index in a node's list. Of two layers of one name the first is meant; an empty name means none. An index may be that of
/// an empty entry of the list.
///
/// Returns an empty string and sets `r_index`, or returns a sentence that names the value which means no layer, and leaves
/// `r_index` as it was.
godot::String find_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// The same for several layers: one reference, or an Array, PackedInt32Array, PackedInt64Array or PackedStringArray of
/// them. `r_indices` gets each layer once, in the order in which they are named; nothing for an empty array, which stands
/// for all layers. A null is refused, since it is more often a variable that was never set than a wish for all layers.
godot::String find_layers(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_references,
		std::vector<std::uint32_t> &r_indices);

/// The layers of a list as they were: another thread can find one among them.
class LayerNames {
public:
	explicit LayerNames(const godot::TypedArray<ScatterLayer> &p_layers);

	int64_t size() const { return static_cast<int64_t>(entries_.size()); }
	bool is_named(int64_t p_index, const godot::String &p_name) const;
	bool holds(int64_t p_index, const godot::Ref<ScatterLayer> &p_layer) const;

private:
	struct Entry {
		std::uint64_t id; ///< Of the layer as an object of the engine; 0 for an empty entry.
		godot::String name;
	};

	std::vector<Entry> entries_;
};

/// The same among these, on any thread.
godot::String find_layers(
		const LayerNames &p_layers, const godot::Variant &p_references, std::vector<std::uint32_t> &r_indices);

/// What a property that is saved keeps of a reference: the name, if it is one or the layer has one; the layer itself if it
/// has no name, or its index. Scenes then hold no layer twice. Null for what cannot mean a layer.
godot::Variant stored_reference(const godot::Variant &p_reference);

/// The same for the core; empty for an empty name.
LayerReference core_reference(const godot::Variant &p_stored);

/// The sentence about a value that cannot mean a layer, for the error of a property that refuses it.
godot::String no_reference(const godot::Variant &p_value);

} // namespace thicket
