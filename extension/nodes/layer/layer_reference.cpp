#include "nodes/layer/layer_reference.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/renames.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The current layers of a node.
class LiveLayers {
public:
	explicit LiveLayers(const TypedArray<ScatterLayer> &p_layers) : layers_(p_layers) {}

	int64_t size() const { return layers_.size(); }
	String name(int64_t p_index) const {
		const Ref<ScatterLayer> layer = layers_[p_index];
		return layer.is_valid() ? layer->get_name() : String();
	}
	bool refers_to(int64_t p_index, const Ref<ScatterLayer> &p_layer) const {
		return Ref<ScatterLayer>(layers_[p_index]) == p_layer;
	}

private:
	const TypedArray<ScatterLayer> &layers_;
};

/// Returns all names in a list for an error message.
template <class Layers>
String names_of(const Layers &p_layers) {
	String names;
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		if (const String name = p_layers.name(index); !name.is_empty()) {
			names = names + String(names.is_empty() ? "\"" : ", \"") + name + String("\"");
		}
	}
	return names.is_empty() ? String("no layer has a name") : String("the names are ") + names;
}

template <class Layers>
String find_name(const Layers &p_layers, const String &p_name, std::uint32_t &r_index) {
	for (int64_t index = 0; index < p_layers.size() && !p_name.is_empty(); ++index) {
		if (p_layers.name(index) == p_name) {
			r_index = static_cast<std::uint32_t>(index);
			return {};
		}
	}
	return vformat("No layer is named \"%s\": %s.", p_name, names_of(p_layers));
}

template <class Layers>
String find_resource(const Layers &p_layers, const Ref<ScatterLayer> &p_layer, std::uint32_t &r_index) {
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		if (p_layers.refers_to(index, p_layer)) {
			r_index = static_cast<std::uint32_t>(index);
			return {};
		}
	}
	const String name = p_layer->get_name();
	const String layer =
			name.is_empty() ? String("A ScatterLayer without a name") : vformat("The ScatterLayer \"%s\"", name);
	return layer + String(" is not in the list of layers: add it to TerrainScatter3D.layers or to a biome.");
}

bool is_list(Variant::Type p_type) { return p_type == Variant::ARRAY || p_type == Variant::PACKED_STRING_ARRAY; }

template <class Layers>
String find_in(const Layers &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	switch (p_reference.get_type()) {
		case Variant::INT:
			return vformat(
					"Pass a ScatterLayer or its name, not the index %s: TerrainScatter3D.get_all_layers() returns "
					"the layers.",
					p_reference);
		case Variant::STRING:
		case Variant::STRING_NAME: return find_name(p_layers, p_reference, r_index);
		case Variant::OBJECT:
			if (const Ref<ScatterLayer> layer = p_reference; layer.is_valid()) {
				return find_resource(p_layers, layer, r_index);
			}
			break;
		default: break;
	}
	return no_reference(p_reference);
}

template <class Layers>
String find_all_in(const Layers &p_layers, const Variant &p_references, std::vector<std::uint32_t> &r_indices) {
	Array references;
	if (is_list(p_references.get_type())) {
		references = static_cast<Array>(p_references);
	} else {
		append(references, p_references);
	}
	std::vector<std::uint32_t> indices;
	for (int64_t i = 0; i < references.size(); ++i) {
		std::uint32_t index = 0;
		if (String problem = find_in(p_layers, references[i], index); !problem.is_empty()) {
			return problem;
		}
		if (std::ranges::find(indices, index) == indices.end()) {
			indices.push_back(index);
		}
	}
	r_indices = std::move(indices);
	return {};
}

} // namespace

ListedLayers::ListedLayers(const TypedArray<ScatterLayer> &p_layers) {
	entries_.reserve(static_cast<std::size_t>(p_layers.size()));
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		entries_.push_back({layer, layer.is_valid() ? layer->get_name() : String()});
	}
}

Ref<ScatterLayer> ListedLayers::at(std::size_t index) const {
	return index < entries_.size() ? entries_[index].layer : Ref<ScatterLayer>();
}

std::uint32_t ListedLayers::find(const Ref<ScatterLayer> &p_layer) const {
	const auto entry = std::ranges::find(entries_, p_layer, &Entry::layer);
	return entry != entries_.end() ? static_cast<std::uint32_t>(entry - entries_.begin()) : no_index;
}

bool ListedLayers::refers_to(int64_t p_index, const Ref<ScatterLayer> &p_layer) const {
	return entries_[static_cast<std::size_t>(p_index)].layer == p_layer;
}

String find_layer(const TypedArray<ScatterLayer> &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	return find_in(LiveLayers(p_layers), p_reference, r_index);
}

String find_layers(
		const TypedArray<ScatterLayer> &p_layers, const Variant &p_references, std::vector<std::uint32_t> &r_indices) {
	return find_all_in(LiveLayers(p_layers), p_references, r_indices);
}

String find_stored_layer(const TypedArray<ScatterLayer> &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	if (p_reference.get_type() != Variant::INT) {
		return find_layer(p_layers, p_reference, r_index);
	}
	const int64_t index = p_reference;
	if (index < 0 || index >= p_layers.size()) {
		return vformat("There is no layer %d: the list of layers has %d entries.", index, p_layers.size());
	}
	r_index = static_cast<std::uint32_t>(index);
	return {};
}

String find_layer(const ListedLayers &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	return find_in(p_layers, p_reference, r_index);
}

String find_layers(const ListedLayers &p_layers, const Variant &p_references, std::vector<std::uint32_t> &r_indices) {
	return find_all_in(p_layers, p_references, r_indices);
}

Variant stored_reference(const Variant &p_reference) {
	switch (p_reference.get_type()) {
		case Variant::INT: return p_reference;
		case Variant::STRING:
		case Variant::STRING_NAME: return static_cast<String>(p_reference);
		case Variant::OBJECT:
			if (const Ref<ScatterLayer> layer = p_reference; layer.is_valid()) {
				const String name = layer->get_name();
				return name.is_empty() ? Variant(layer) : Variant(name);
			}
			return {};
		default: return {};
	}
}

LayerReference core_reference(const Variant &p_stored) {
	LayerReference result;
	if (p_stored.get_type() == Variant::INT) {
		result.index = p_stored;
	} else if (const Ref<ScatterLayer> layer = p_stored; layer.is_valid()) {
		result.identity = layer->get_instance_id();
	} else {
		result.name = static_cast<String>(p_stored).utf8().get_data();
	}
	return result;
}

Variant accept_reference(const char *p_property, const Variant &p_reference, const Resource *p_holder) {
	Variant reference = stored_reference(p_reference);
	const Ref<ScatterLayer> stored_layer = reference;
	String problem;
	if (reference.get_type() == Variant::NIL) {
		problem = no_reference(p_reference);
	} else if (stored_layer.is_valid() && stored_layer->stores(p_holder)) {
		problem = layer_cycle_problem;
	}
	if (!problem.is_empty()) {
		ERR_PRINT(vformat("%s: %s", p_property, problem));
		return {};
	}
	return reference;
}

ReferenceChange renaming_layer(const String &p_from, const String &p_to) {
	return [p_from, p_to](const char *, const Variant &p_stored) -> std::optional<Variant> {
		if (p_from.is_empty()) {
			const Ref<ScatterLayer> stored_layer = p_stored;
			return stored_layer.is_valid() && !stored_layer->get_name().is_empty() ? std::optional(p_stored)
																				   : std::nullopt;
		}
		const bool is_renamed = p_stored.get_type() == Variant::STRING && static_cast<String>(p_stored) == p_from;
		return is_renamed ? std::optional<Variant>(p_to) : std::nullopt;
	};
}

ReferenceChange naming_layers(const TypedArray<ScatterLayer> &p_layers) {
	return [p_layers](const char *p_property, const Variant &p_stored) -> std::optional<Variant> {
		std::uint32_t index = 0;
		if (p_stored.get_type() != Variant::INT || !find_stored_layer(p_layers, p_stored, index).is_empty()) {
			return std::nullopt;
		}
		const Ref<ScatterLayer> layer = p_layers[static_cast<int64_t>(index)];
		if (layer.is_null()) {
			return std::nullopt;
		}
		warn_of_change(p_property, "refers to layers by their names, not by their indices,");
		return Variant(layer);
	};
}

std::optional<Variant> changed_reference(
		const ReferenceChange &change, const char *p_property, const Variant &p_stored, const Resource *p_holder) {
	std::optional<Variant> new_reference = change(p_property, p_stored);
	const Ref<ScatterLayer> stored_layer = new_reference ? stored_reference(*new_reference) : Variant();
	return stored_layer.is_valid() && stored_layer->stores(p_holder) ? std::nullopt : new_reference;
}

Array current_references(const Array &p_stored) {
	Array result;
	for (int64_t i = 0; i < p_stored.size(); ++i) {
		append(result, stored_reference(p_stored[i]));
	}
	result.make_read_only();
	return result;
}

std::optional<Array> changed_references(
		const Array &p_stored, const std::function<std::optional<Variant>(const Variant &)> &change) {
	Array new_references;
	bool any_changed = false;
	for (int64_t i = 0; i < p_stored.size(); ++i) {
		const std::optional<Variant> new_reference = change(p_stored[i]);
		append(new_references, new_reference ? *new_reference : p_stored[i]);
		any_changed = any_changed || new_reference.has_value();
	}
	return any_changed ? std::optional(new_references) : std::nullopt;
}

String no_reference(const Variant &p_value) { return vformat("Pass a ScatterLayer or its name, not %s.", p_value); }

} // namespace thicket
