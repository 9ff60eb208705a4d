#pragma once

#include "core/base/status.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// Finds the layer that a script or a scene refers to: by the ScatterLayer itself, its name (a String or StringName) or its index in a
/// node's list. If two layers share a name, the first one is found. An empty name refers to no layer. An index may be that of an empty
/// entry of the list.
///
/// Returns an empty string and sets `r_index`. If the value refers to no layer, returns a sentence that names the value, and leaves
/// `r_index` unchanged.
godot::String find_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// The same for several layers: one reference, or an Array, PackedInt32Array, PackedInt64Array or PackedStringArray of them. `r_indices`
/// gets each layer once, in the order of the references. An empty array adds nothing and stands for all layers. Null is refused, because it
/// is more often a variable that was never set than a request for all layers.
godot::String find_layers(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_references,
		std::vector<std::uint32_t> &r_indices);

/// The error of a call with a layer whose settings are refused.
inline Status refused_layer() { return Status::missing("layer", "Fix the problems that its get_problems() returns"); }

/// A copy of the names and object IDs of a list's layers, so that another thread can find a layer among them.
class LayerNames {
public:
	explicit LayerNames(const godot::TypedArray<ScatterLayer> &p_layers);

	int64_t size() const { return static_cast<int64_t>(entries_.size()); }
	bool is_named(int64_t p_index, const godot::String &p_name) const;
	bool holds(int64_t p_index, const godot::Ref<ScatterLayer> &p_layer) const;

private:
	struct Entry {
		std::uint64_t id; ///< The layer's object ID in the engine; 0 for an empty entry.
		godot::String name;
	};

	std::vector<Entry> entries_;
};

/// The same among these layers, on any thread.
godot::String find_layers(
		const LayerNames &p_layers, const godot::Variant &p_references, std::vector<std::uint32_t> &r_indices);

/// The form in which a saved property stores a reference: a name, if the reference is one or the layer has one; the layer itself if it has
/// no name; or its index. Scenes then store no layer twice. Null if the value cannot refer to a layer.
godot::Variant stored_reference(const godot::Variant &p_reference);

/// The same reference for the core; empty for an empty name.
LayerReference core_reference(const godot::Variant &p_stored);

/// The error message for a property that refuses a value because it cannot refer to a layer.
godot::String no_reference(const godot::Variant &p_value);

} // namespace thicket
