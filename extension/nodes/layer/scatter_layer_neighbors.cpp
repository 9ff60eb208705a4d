// A layer's references to other layers: the properties of the group Other Layers.

#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr double min_distance = 1e-3; ///< Meters, between layers.

constexpr NumberProperty proximity_distance{"proximity_distance", &LayerLinks::proximity_distance, min_distance,
		max_neighbor_distance, PROPERTY_HINT_RANGE, "0.1,200,0.01,or_less,or_greater,exp,suffix:m"};
constexpr ResourceProperty proximity_curve{"proximity_curve", &LayerLinks::proximity_curve, curve_table};

double number_of(const Variant &p_value) {
	const bool is_number = p_value.get_type() == Variant::FLOAT || p_value.get_type() == Variant::INT;
	return is_number ? static_cast<double>(p_value) : std::numeric_limits<double>::quiet_NaN();
}

/// Whether a stored reference means the layer of that name. For an empty name: whether it holds a layer that now has a name.
bool is_named(const Variant &p_stored, const String &p_name) {
	if (p_name.is_empty()) {
		const Ref<ScatterLayer> held = p_stored;
		return held.is_valid() && !held->get_name().is_empty();
	}
	return p_stored.get_type() == Variant::STRING && static_cast<String>(p_stored) == p_name;
}

} // namespace

/// Whether a scene that stores this layer also stores the other one inside it.
bool ScatterLayer::stores(const ScatterLayer *p_layer) const {
	const auto is_stored = [p_layer](const Ref<ScatterLayer> &held) {
		return held.is_valid() && (held.ptr() == p_layer || held->stores(p_layer));
	};
	const Array references = spacing_property_.keys();
	bool found = is_stored(proximity_layer_) || is_stored(color_source_layer_) || is_stored(variation_source_layer_);
	for (int64_t i = 0; !found && i < references.size(); ++i) {
		found = is_stored(references[i]);
	}
	return found;
}

/// The reference in the form to store. Null, with an error, if it is refused.
Variant ScatterLayer::accept_reference(const char *p_property, const Variant &p_reference) const {
	Variant stored = stored_reference(p_reference);
	const Ref<ScatterLayer> held = stored;
	String problem;
	if (stored.get_type() == Variant::NIL) {
		problem = no_reference(p_reference);
	} else if (held.is_valid() && (held.ptr() == this || held->stores(this))) {
		problem = "Layers without names may not refer to each other in a circle, which no scene could store: give them "
				  "names.";
	}
	if (!problem.is_empty()) {
		ERR_PRINT(vformat("ScatterLayer.%s: %s", p_property, problem));
		return {};
	}
	return stored;
}

void ScatterLayer::set_spacing(const Dictionary &p_spacing) {
	if (p_spacing.size() > static_cast<int64_t>(max_neighbors)) {
		report(layer_class_name, Status::wrong_size("spacing", p_spacing.size(), at_most(max_neighbors, "entries")));
		return;
	}
	Dictionary spacing; // A copy, because scripts share dictionaries.
	std::map<LayerReference, double> linked;
	const Array references = p_spacing.keys();
	for (int64_t i = 0; i < references.size(); ++i) {
		const double distance = number_of(p_spacing[references[i]]);
		Variant stored = accept_reference("spacing", references[i]);
		if (stored.get_type() == Variant::NIL ||
				!accept_number(layer_class_name, "spacing", distance, min_distance, max_neighbor_distance)) {
			return;
		}
		double &meters = linked[core_reference(stored)];
		meters = std::max(meters, distance);
		spacing[stored] = meters;
	}
	spacing.make_read_only();
	spacing_property_ = spacing;
	links_.spacing = std::move(linked);
	changed();
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

/// Sets a property that refers to one layer or none.
void ScatterLayer::set_reference(
		const char *p_property, const Variant &p_layer, Variant &r_stored, LayerReference &r_linked) {
	Variant stored = String();
	if (p_layer.get_type() != Variant::NIL) {
		stored = accept_reference(p_property, p_layer);
	}
	if (stored.get_type() != Variant::NIL && core_reference(stored) != r_linked) {
		r_stored = stored;
		r_linked = core_reference(stored);
		changed();
	}
}

void ScatterLayer::set_proximity_layer(const Variant &p_layer) {
	set_reference("proximity_layer", p_layer, proximity_layer_, links_.proximity_layer);
}

Variant ScatterLayer::get_proximity_layer() const { return stored_reference(proximity_layer_); }

void ScatterLayer::rename_references(const String &p_from, const String &p_to) {
	const auto follow = [&](const Variant &p_stored, void (ScatterLayer::*set)(const Variant &)) {
		if (is_named(p_stored, p_from)) {
			(this->*set)(p_from.is_empty() ? Variant(p_stored) : Variant(p_to));
		}
	};
	follow(proximity_layer_, &ScatterLayer::set_proximity_layer);
	follow(color_source_layer_, &ScatterLayer::set_color_source_layer);
	follow(variation_source_layer_, &ScatterLayer::set_variation_source_layer);
	const Dictionary spacing = spacing_property_;
	const Array references = spacing.keys();
	Dictionary renamed; // A new Dictionary keeps the order in the inspector.
	bool any = false;
	for (int64_t i = 0; i < references.size(); ++i) {
		const bool meant = is_named(references[i], p_from);
		const Variant reference = meant && !p_from.is_empty() ? Variant(p_to) : references[i];
		// If the new name was already in the Dictionary, the larger distance counts. fmax ignores a missing number, which is NAN.
		renamed[reference] = std::fmax(number_of(renamed[reference]), number_of(spacing[references[i]]));
		any = any || meant;
	}
	if (any) {
		set_spacing(renamed);
	}
}

String ScatterLayer::find_free_name(const String &p_name, const PackedStringArray &p_taken) const {
	std::vector<std::string> taken;
	for (const String &name : p_taken) {
		taken.emplace_back(name.utf8().get_data());
	}
	return String::utf8(free_layer_name(p_name.utf8().get_data(), taken).c_str());
}

void ScatterLayer::bind_neighbors() {
	ADD_GROUP("Other Layers", "");
	bind_guarded<&ScatterLayer::find_free_name>(D_METHOD("find_free_name", "name", "taken"));
	bind_guarded<&ScatterLayer::set_spacing>(D_METHOD("set_spacing", "spacing"));
	bind_guarded<&ScatterLayer::get_spacing>(D_METHOD("get_spacing"));
	add_layer_property(
			PropertyUse::placement, PropertyInfo(Variant::DICTIONARY, "spacing"), "set_spacing", "get_spacing");
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
