#pragma once

#include "core/base/status.hpp"
#include "nodes/layer/reference_change.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Finds the layer that a script has passed, as a ScatterLayer or as its name (a String or StringName). If two layers
/// share a name, the first one is found. An empty name refers to no layer. An index is refused, because it refers to a
/// different layer once the list changes.
///
/// Returns an empty string and sets `r_index`. If the value refers to no layer, returns a sentence that names the value and what is
/// allowed, and leaves `r_index` unchanged.
godot::String find_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// Finds several layers: one reference, or an Array or PackedStringArray of them. `r_indices` gets each layer once, in
/// the order of the references. An empty array means all layers, and adds nothing. Null is refused, because it is more
/// often a variable that was never set than a request for all layers.
godot::String find_layers(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_references,
		std::vector<std::uint32_t> &r_indices);

/// Finds the layer that a property refers to; see stored_reference. The reference may be an index, which stays if no
/// layer has that index.
godot::String find_stored_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// The error of a call with a layer whose settings are refused.
inline Status refused_layer() { return Status::missing("layer", "Fix the problems that its get_problems() returns"); }

/// The layers of a node at one moment, and their names at that moment, by the index that the core uses for them. For
/// results and for other threads.
class ListedLayers {
public:
	explicit ListedLayers(const godot::TypedArray<ScatterLayer> &p_layers);

	int64_t size() const { return static_cast<int64_t>(entries_.size()); }

	/// Null for an empty entry, and for an index beyond the list.
	godot::Ref<ScatterLayer> at(std::size_t index) const;

	/// The first index of a layer; `no_index` if it is not listed.
	std::uint32_t find(const godot::Ref<ScatterLayer> &p_layer) const;
	static constexpr std::uint32_t no_index = 0xffffffff;

	// find_layer calls these functions with an index in the list.
	godot::String name(int64_t p_index) const { return entries_[static_cast<std::size_t>(p_index)].name; }
	bool holds(int64_t p_index, const godot::Ref<ScatterLayer> &p_layer) const;

private:
	struct Entry {
		godot::Ref<ScatterLayer> layer;
		godot::String name;
	};

	std::vector<Entry> entries_;
};

using SharedLayers = std::shared_ptr<const ListedLayers>;

// These overloads search a list of layers, on any thread.
godot::String find_layer(const ListedLayers &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);
godot::String find_layers(
		const ListedLayers &p_layers, const godot::Variant &p_references, std::vector<std::uint32_t> &r_indices);

/// Converts a reference to the form in which properties save it: the name of the layer or, if it has none, the layer
/// itself. So scenes store no layer twice. An index stays an index until the node that has the list replaces it (see
/// `naming_layers`). Null if the value cannot refer to a layer.
godot::Variant stored_reference(const godot::Variant &p_reference);

/// The stored form of a reference, for a property of the resource `p_holder`. Returns null, with an error that names
/// the property, for a value that cannot refer to a layer. Also refuses a layer without a name that stores `p_holder`
/// inside of it, because no scene could store both.
godot::Variant accept_reference(
		const char *p_property, const godot::Variant &p_reference, const godot::Resource *p_holder);

/// Updates references after a layer was renamed. If `p_from` is empty, the layer had no name, and references stored the
/// object.
ReferenceChange renaming_layer(const godot::String &p_from, const godot::String &p_to);

/// Replaces each index with the layer at that index, and warns once for each property. Release 0.2 stored references as
/// indices. Keeps an index without a layer.
ReferenceChange naming_layers(const godot::TypedArray<ScatterLayer> &p_layers);

/// Returns the new form of a stored reference of `holder`; empty if the reference stays. It also stays if the holder
/// could not store the new form; see accept_reference.
std::optional<godot::Variant> changed_reference(const ReferenceChange &change, const char *p_property,
		const godot::Variant &p_stored, const godot::Resource *p_holder);

/// Converts a stored reference for the core; empty for an empty name.
LayerReference core_reference(const godot::Variant &p_stored);

inline constexpr const char *layers_in_circle =
		"Layers without names may not refer to each other in a circle, which no scene could store: give them names.";

/// The error message for a value that cannot refer to a layer.
godot::String no_reference(const godot::Variant &p_value);

} // namespace thicket
