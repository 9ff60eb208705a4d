#include "nodes/layer/layer_reference.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The current layers of a node.
class LiveLayers {
public:
	explicit LiveLayers(const TypedArray<ScatterLayer> &p_layers) : layers_(p_layers) {}

	int64_t size() const { return layers_.size(); }
	bool is_named(int64_t p_index, const String &p_name) const {
		const Ref<ScatterLayer> layer = layers_[p_index];
		return layer.is_valid() && layer->get_name() == p_name;
	}
	bool holds(int64_t p_index, const Ref<ScatterLayer> &p_layer) const {
		return Ref<ScatterLayer>(layers_[p_index]) == p_layer;
	}

private:
	const TypedArray<ScatterLayer> &layers_;
};

template <class Layers>
String find_index(const Layers &p_layers, int64_t p_index, std::uint32_t &r_index) {
	if (p_index < 0 || p_index >= p_layers.size()) {
		return vformat("There is no layer %d: the list of layers has %d entries.", p_index, p_layers.size());
	}
	r_index = static_cast<std::uint32_t>(p_index);
	return {};
}

template <class Layers>
String find_name(const Layers &p_layers, const String &p_name, std::uint32_t &r_index) {
	for (int64_t index = 0; index < p_layers.size() && !p_name.is_empty(); ++index) {
		if (p_layers.is_named(index, p_name)) {
			return find_index(p_layers, index, r_index);
		}
	}
	return vformat("No layer is named \"%s\".", p_name);
}

template <class Layers>
String find_resource(const Layers &p_layers, const Ref<ScatterLayer> &p_layer, std::uint32_t &r_index) {
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		if (p_layers.holds(index, p_layer)) {
			return find_index(p_layers, index, r_index);
		}
	}
	const String name = p_layer->get_name();
	return name.is_empty() ? String("A ScatterLayer without a name is not in the list of layers.")
						   : vformat("The ScatterLayer \"%s\" is not in the list of layers.", name);
}

bool is_list(Variant::Type p_type) {
	return p_type == Variant::ARRAY || p_type == Variant::PACKED_INT32_ARRAY || p_type == Variant::PACKED_INT64_ARRAY ||
			p_type == Variant::PACKED_STRING_ARRAY;
}

template <class Layers>
String find_in(const Layers &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	switch (p_reference.get_type()) {
		case Variant::INT: return find_index(p_layers, p_reference, r_index);
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
	for (int64_t at = 0; at < references.size(); ++at) {
		std::uint32_t index = 0;
		if (String problem = find_in(p_layers, references[at], index); !problem.is_empty()) {
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

LayerNames::LayerNames(const TypedArray<ScatterLayer> &p_layers) {
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		entries_.push_back(layer.is_valid() ? Entry{layer->get_instance_id(), layer->get_name()} : Entry{0, String()});
	}
}

bool LayerNames::is_named(int64_t p_index, const String &p_name) const {
	const Entry &entry = entries_[static_cast<std::size_t>(p_index)];
	return entry.id != 0 && entry.name == p_name;
}

bool LayerNames::holds(int64_t p_index, const Ref<ScatterLayer> &p_layer) const {
	return entries_[static_cast<std::size_t>(p_index)].id == p_layer->get_instance_id();
}

String find_layer(const TypedArray<ScatterLayer> &p_layers, const Variant &p_reference, std::uint32_t &r_index) {
	return find_in(LiveLayers(p_layers), p_reference, r_index);
}

String find_layers(
		const TypedArray<ScatterLayer> &p_layers, const Variant &p_references, std::vector<std::uint32_t> &r_indices) {
	return find_all_in(LiveLayers(p_layers), p_references, r_indices);
}

String find_layers(const LayerNames &p_layers, const Variant &p_references, std::vector<std::uint32_t> &r_indices) {
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

String no_reference(const Variant &p_value) {
	return vformat("A layer is meant by a ScatterLayer, its name or its index, not by %s.", p_value);
}

} // namespace thicket
