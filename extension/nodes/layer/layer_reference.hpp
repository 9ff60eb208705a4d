#pragma once

#include "core/base/status.hpp"
#include "nodes/layer/reference_change.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

/// Finds the layer that a script has passed, as a ScatterLayer or by name (a String or StringName).
/// If several layers share a name, finds the first one. An empty name refers to no layer. Indices
/// are rejected, because they may refer to another layer after the list changes.
///
/// Sets `r_index` and returns an empty string. If the value refers to no layer, leaves `r_index`
/// unchanged and returns an error message with the value and the allowed values.
godot::String find_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// Finds several layers from one reference, or from an Array or PackedStringArray of references.
/// Adds each layer to `r_indices` once, in the order of the references. An empty array means all
/// layers and adds nothing. Null is rejected, because it is usually a variable that was never set.
godot::String find_layers(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_references,
		std::vector<std::uint32_t> &r_indices);

/// Finds the layer that a property refers to (see stored_reference). The reference may also be an
/// index.
godot::String find_stored_layer(
		const godot::TypedArray<ScatterLayer> &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);

/// Returns the error for a call with a layer whose settings are invalid.
inline Status refused_layer() {
	return Status::missing("layer", "Fix the problems that TerrainScatter3D.get_problems() returns");
}

/// A node's layers and their names at one moment. The core uses the same indices. Query results
/// keep this list, and other threads search it.
class ListedLayers {
public:
	explicit ListedLayers(const godot::TypedArray<ScatterLayer> &p_layers);

	int64_t size() const { return static_cast<int64_t>(entries_.size()); }

	/// Returns the layer at an index; null for an empty entry, and for an index out of range.
	godot::Ref<ScatterLayer> at(std::size_t index) const;

	/// Returns the first index of a layer; `no_index` if it is not listed.
	std::uint32_t find(const godot::Ref<ScatterLayer> &p_layer) const;
	static constexpr std::uint32_t no_index = 0xffffffff;

	// find_layer calls the following functions. The index must be in range.
	godot::String name(int64_t p_index) const { return entries_[static_cast<std::size_t>(p_index)].name; }
	bool refers_to(int64_t p_index, const godot::Ref<ScatterLayer> &p_layer) const;

private:
	struct Entry {
		godot::Ref<ScatterLayer> layer;
		godot::String name;
	};

	std::vector<Entry> entries_;
};

using SharedLayers = std::shared_ptr<const ListedLayers>;

// Any thread may call these overloads.
godot::String find_layer(const ListedLayers &p_layers, const godot::Variant &p_reference, std::uint32_t &r_index);
godot::String find_layers(
		const ListedLayers &p_layers, const godot::Variant &p_references, std::vector<std::uint32_t> &r_indices);

/// Converts a reference to the form in which properties save it: the name of the layer or, if it
/// has none, the layer itself. As a result, no scene stores a named layer twice. An index stays an
/// index until the node with the list of layers replaces it (see `naming_layers`). Returns null if
/// the value cannot refer to a layer.
godot::Variant stored_reference(const godot::Variant &p_reference);

/// Returns the stored form of a reference for a property of the resource `p_holder`. If the value
/// cannot refer to a layer, prints an error that names the property and returns null. Also rejects
/// an unnamed layer that itself stores `p_holder`, because no scene could store such a cycle.
godot::Variant accept_reference(
		const char *p_property, const godot::Variant &p_reference, const godot::Resource *p_holder);

/// Returns a change that updates references after a layer was renamed. If `p_from` is empty, the
/// layer had no name, and references to it are objects.
ReferenceChange renaming_layer(const godot::String &p_from, const godot::String &p_to);

/// Returns a change that replaces each index with a reference to the layer at that index, and warns
/// once per property. Release 0.2 stored references as indices. An index out of range stays
/// unchanged.
ReferenceChange naming_layers(const godot::TypedArray<ScatterLayer> &p_layers);

/// Returns the new form of a stored reference of `p_holder`. The result is empty if the reference
/// stays unchanged, for example because the holder cannot store the new form (see
/// accept_reference).
std::optional<godot::Variant> changed_reference(const ReferenceChange &change, const char *p_property,
		const godot::Variant &p_stored, const godot::Resource *p_holder);

/// Returns the value of a property with a list of stored references. It is a read-only copy that
/// refers by name to layers that have been named since.
godot::Array current_references(const godot::Array &p_stored);

/// Returns a list of stored references with a change applied to each of them; empty if none
/// changes. The function `change` returns the new form of a reference; empty to keep the old one.
std::optional<godot::Array> changed_references(const godot::Array &p_stored,
		const std::function<std::optional<godot::Variant>(const godot::Variant &)> &change);

/// Converts a stored reference to the core's form; empty for an empty name.
LayerReference core_reference(const godot::Variant &p_stored);

inline constexpr const char *layer_cycle_problem =
		"Layers without names must not refer to each other in a cycle, which no scene could store: give them names.";

/// Returns the error message for a value that cannot refer to a layer.
godot::String no_reference(const godot::Variant &p_value);

} // namespace thicket
