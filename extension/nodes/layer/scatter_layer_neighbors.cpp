// This file contains the properties of ScatterLayer in the group Other Layers, which refer to other
// layers.

#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr double min_distance = 1e-3; ///< The minimum distance between layers, in meters.

constexpr NumberProperty proximity_distance{"proximity_distance", &LayerLinks::proximity_distance, min_distance,
		max_neighbor_distance, PROPERTY_HINT_RANGE, "0.1,200,0.01,or_less,or_greater,exp,suffix:m"};
constexpr SwitchProperty spacing_fills{"spacing_fills", "is_spacing_filling", &LayerLinks::spacing_fills};
constexpr ResourceProperty proximity_curve{"proximity_curve", &LayerLinks::proximity_curve, curve_table};

/// Returns a number, or NAN for a value of any other type.
double number_of(const Variant &p_value) {
	const bool is_number = p_value.get_type() == Variant::FLOAT || p_value.get_type() == Variant::INT;
	return is_number ? static_cast<double>(p_value) : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

bool ScatterLayer::stores(const Resource *p_resource) const {
	const auto is_stored = [p_resource](const Variant &p_reference) {
		const Ref<ScatterLayer> referenced = p_reference;
		return referenced.is_valid() && referenced->stores(p_resource);
	};
	const Array references = spacing_property_.keys();
	bool stores_it = p_resource == this || is_stored(proximity_layer_);
	for (const Ref<ScatterValueSource> &value : {color_value_, variation_value_, scale_value_}) {
		stores_it = stores_it || (value.is_valid() && (p_resource == value.ptr() || is_stored(value->stored_layer())));
	}
	for (int64_t i = 0; !stores_it && i < references.size(); ++i) {
		stores_it = is_stored(references[i]);
	}
	for (int64_t i = 0; !stores_it && i < surface_layers_.size(); ++i) {
		stores_it = is_stored(surface_layers_[i]);
	}
	return stores_it;
}

void ScatterLayer::set_spacing(const Dictionary &p_spacing) {
	if (p_spacing.size() > static_cast<int64_t>(max_neighbors)) {
		report(ScatterLayer::class_name,
				Status::wrong_size("spacing", p_spacing.size(), at_most(max_neighbors, "entries")));
		return;
	}
	Dictionary spacing; // Use a copy, because scripts share dictionaries by reference.
	std::map<LayerReference, double> link_distances;
	const Array references = p_spacing.keys();
	for (int64_t i = 0; i < references.size(); ++i) {
		const double distance = number_of(p_spacing[references[i]]);
		Variant reference = accept_reference("ScatterLayer.spacing", references[i], this);
		if (reference.get_type() == Variant::NIL ||
				!accept_number(ScatterLayer::class_name, "spacing", distance, min_distance, max_neighbor_distance)) {
			return;
		}
		double &meters = link_distances[core_reference(reference)];
		meters = std::max(meters, distance);
		spacing[reference] = meters;
	}
	spacing.make_read_only();
	spacing_property_ = spacing;
	links_.spacing = std::move(link_distances);
	mark_changed();
}

Dictionary ScatterLayer::get_spacing() const {
	Dictionary result;
	const Array references = spacing_property_.keys();
	for (int64_t i = 0; i < references.size(); ++i) {
		result[stored_reference(references[i])] = std::as_const(spacing_property_)[references[i]];
	}
	result.make_read_only();
	return result;
}

void ScatterLayer::set_proximity_layer(const Variant &p_layer) {
	Variant reference = String();
	if (p_layer.get_type() != Variant::NIL) {
		reference = accept_reference("ScatterLayer.proximity_layer", p_layer, this);
	}
	if (reference.get_type() != Variant::NIL && core_reference(reference) != links_.proximity_layer) {
		proximity_layer_ = reference;
		links_.proximity_layer = core_reference(reference);
		mark_changed();
	}
}

Variant ScatterLayer::get_proximity_layer() const { return stored_reference(proximity_layer_); }

/// Applies a change of references to the names of layers in expressions.
void ScatterLayer::rename_in_expressions(const ReferenceChange &change) {
	const auto rename = [&change](const char *property, const SharedExpression &expression) {
		std::string text = expression != nullptr ? expression->text() : std::string();
		const std::span<const WorldInput> inputs =
				expression != nullptr ? expression->world_inputs() : std::span<const WorldInput>();
		for (const WorldInput &input : inputs) {
			const std::optional<Variant> new_name = input.kind == WorldInputKind::distance
					? change(property, Variant(String::utf8(input.name.c_str())))
					: std::nullopt;
			if (new_name && new_name->get_type() == Variant::STRING && !static_cast<String>(*new_name).is_empty()) {
				text = with_renamed_layer(text, input.name, static_cast<String>(*new_name).utf8().get_data());
			}
		}
		return String::utf8(text.c_str());
	};
	const std::vector<WorldInput> inputs = world_inputs();
	const auto is_distance = [](const WorldInput &input) {
		return input.kind == WorldInputKind::distance;
	};
	if (std::ranges::any_of(inputs, is_distance)) {
		set_density_expression(rename("ScatterLayer.density_expression", settings_.rules.expression));
		PackedStringArray texts;
		for (const SharedExpression &expression : mesh_expressions_) {
			texts.push_back(rename("ScatterLayer.mesh_density_expressions", expression));
		}
		set_mesh_density_expressions(texts);
	}
}

void ScatterLayer::change_references(const ReferenceChange &change) {
	if (const auto new_reference = changed_reference(change, "ScatterLayer.proximity_layer", proximity_layer_, this)) {
		set_proximity_layer(*new_reference);
	}
	for (const Ref<ScatterValueSource> &value : {color_value_, variation_value_, scale_value_}) {
		if (value.is_valid()) {
			value->change_reference(change);
		}
	}
	change_surface_layers(change);
	rename_in_expressions(change);
	const Dictionary spacing = spacing_property_;
	if (spacing.is_empty()) {
		return; // Return early, because the node calls this function after every change.
	}
	const Array references = spacing.keys();
	Dictionary new_spacing; // A new Dictionary, to keep the order of the entries in the inspector.
	bool any_changed = false;
	for (int64_t i = 0; i < references.size(); ++i) {
		const auto new_reference = changed_reference(change, "ScatterLayer.spacing", references[i], this);
		const Variant reference = stored_reference(new_reference ? *new_reference : references[i]);
		// If the new name is already in the Dictionary, the larger distance is used. fmax ignores
		// NAN, the value for a missing number.
		new_spacing[reference] = std::fmax(number_of(new_spacing[reference]), number_of(spacing[references[i]]));
		any_changed = any_changed || new_reference.has_value();
	}
	if (any_changed) {
		set_spacing(new_spacing);
	}
}

String ScatterLayer::find_free_name(const String &p_name, const PackedStringArray &p_taken) const {
	std::vector<std::string> used_names;
	for (const String &name : p_taken) {
		used_names.emplace_back(name.utf8().get_data());
	}
	return String::utf8(free_layer_name(p_name.utf8().get_data(), used_names).c_str());
}

void ScatterLayer::bind_neighbors() {
	ADD_GROUP("Other Layers", "");
	bind_guarded<&ScatterLayer::find_free_name>(D_METHOD("find_free_name", "name", "taken"));
	bind_guarded<&ScatterLayer::set_spacing>(D_METHOD("set_spacing", "spacing"));
	bind_guarded<&ScatterLayer::get_spacing>(D_METHOD("get_spacing"));
	add_layer_property(
			PropertyUse::placement, PropertyInfo(Variant::DICTIONARY, "spacing"), "set_spacing", "get_spacing");
	bind_switch<spacing_fills>();
	ADD_SUBGROUP("Proximity", "proximity_");
	bind_guarded<&ScatterLayer::set_proximity_layer>(D_METHOD("set_proximity_layer", "layer"));
	bind_guarded<&ScatterLayer::get_proximity_layer>(D_METHOD("get_proximity_layer"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::NIL, "proximity_layer", PROPERTY_HINT_NONE, String(),
					PROPERTY_USAGE_DEFAULT | PROPERTY_USAGE_NIL_IS_VARIANT),
			"set_proximity_layer", "get_proximity_layer");
	bind_number<proximity_distance>();
	ClassDB::bind_integer_constant(get_class_static(), "", "MAX_NEIGHBORS", max_neighbors);
	bind_resource<proximity_curve>();
}

} // namespace thicket
