// This file contains the properties of ScatterLayer for the sources of an instance's color,
// variation and scale.

#include "nodes/common/renames.hpp"
#include "nodes/common/watch.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/memory.hpp>

#include <array>
#include <string>

using namespace godot;

namespace thicket {

namespace {

constexpr SwitchProperty use_colors{"use_colors", "is_using_colors", &InstanceData::use_colors};
constexpr SwitchProperty use_custom_data{"use_custom_data", "is_using_custom_data", &InstanceData::use_custom_data};

/// A property in which release 0.2 saved a property of a ScatterValueSource.
struct FormerValue {
	const char *former_name;
	bool is_color;        ///< True for color_value, false for variation_value.
	const char *property; ///< The property of ScatterValueSource.
};
constexpr std::array former_values{
		FormerValue{"color_gradient", true, "gradient"},
		FormerValue{"color_source", true, "source"},
		FormerValue{"color_source_layer", true, "layer"},
		FormerValue{"color_source_noise", true, "noise"},
		FormerValue{"color_source_min", true, "min_value"},
		FormerValue{"color_source_max", true, "max_value"},
		FormerValue{"color_randomness", true, "randomness"},
		FormerValue{"variation_source", false, "source"},
		FormerValue{"variation_source_layer", false, "layer"},
		FormerValue{"variation_source_noise", false, "noise"},
		FormerValue{"variation_source_min", false, "min_value"},
		FormerValue{"variation_source_max", false, "max_value"},
		FormerValue{"variation_randomness", false, "randomness"},
};

PropertyInfo value_property(const char *p_name) {
	return PropertyInfo(Variant::OBJECT, p_name, PROPERTY_HINT_RESOURCE_TYPE, ScatterValueSource::class_name);
}

/// Returns the settings of a value without those that its source does not use, so that changes to
/// unused settings regenerate nothing.
InstanceSource used_settings(const Ref<ScatterValueSource> &p_value, bool is_used) {
	if (!is_used || p_value.is_null()) {
		return {};
	}
	InstanceSource result = p_value->current();
	if (result.kind == SourceKind::random) {
		return {.curve = result.curve};
	}
	if (result.kind != SourceKind::noise) {
		result.noise = nullptr;
	}
	return result;
}

/// Collects the problems of one value.
class ValueProblems {
public:
	ValueProblems(const char *p_name, ScatterValueSource &value, PackedStringArray &r_problems) :
			name_("ScatterLayer." + String(p_name)), source_(value.current()), problems_(r_problems),
			has_noise_(value.get_noise().is_valid()), has_layer_(!core_reference(value.stored_layer()).empty()) {}

	/// Adds the problems of the value. `p_reason` explains why the value has no effect; it is empty
	/// if the value has an effect.
	void add(const String &p_reason) {
		if (!p_reason.is_empty()) {
			problems_.push_back(name_ + String(" ") + p_reason);
			return;
		}
		add_unused(".noise", has_noise_, SourceKind::noise, "Noise");
		add_unused(".layer", has_layer_, SourceKind::distance, "Distance");
		if (source_.kind == SourceKind::noise && !has_noise_) {
			problems_.push_back(
					name_ + String(".source is Noise, but there is no noise, so the value is random. Set noise."));
		}
		if (source_.kind == SourceKind::distance && !has_layer_) {
			problems_.push_back(
					name_ + String(".source is Distance, but names no layer, so the value is random. Set layer."));
		}
		if (source_.kind != SourceKind::random && source_.randomness >= 1.0) {
			problems_.push_back(name_ + String(".source has no effect: the randomness is 1. Lower randomness."));
		}
		add_default_range(SourceKind::height, "meters of height");
		add_default_range(SourceKind::slope, "degrees of slope");
	}

private:
	void add_unused(const char *p_part, bool is_set, SourceKind kind, const char *p_kind) {
		if (is_set && source_.kind != kind) {
			problems_.push_back(name_ + String(p_part) + String(" is not used: the source is not ") + p_kind +
					String(". Clear it."));
		}
	}

	/// Reports the default range of 0 to 1, which is rarely correct for the unit of the source.
	void add_default_range(SourceKind kind, const char *p_unit) {
		if (source_.kind == kind && source_.min == 0.0 && source_.max == 1.0) {
			problems_.push_back(name_ + String(" still has the default range of 0 to 1 ") + p_unit +
					String(": set its min_value and max_value."));
		}
	}

	String name_;
	const InstanceSource &source_;
	PackedStringArray &problems_;
	bool has_noise_;
	bool has_layer_;
};

} // namespace

InstanceData ScatterLayer::instance_data() const {
	InstanceData result = settings_.instance_data;
	if (result.use_colors && color_value_.is_valid()) {
		result.colors = color_value_->current_colors();
	}
	static_cast<InstanceSource &>(result.color) = used_settings(color_value_, result.colors != nullptr);
	static_cast<InstanceSource &>(result.variation) = used_settings(variation_value_, result.use_custom_data);
	const Placement &placement = settings_.placement;
	static_cast<InstanceSource &>(result.scale) =
			used_settings(scale_value_, placement.min_scale != placement.max_scale);
	return result;
}

/// Watches the values together, because they may be the same object.
void ScatterLayer::watch_values(bool p_watch) {
	for (const Ref<ScatterValueSource> &value : {color_value_, variation_value_, scale_value_}) {
		watch(value.ptr(), "changed", this, "emit_changed", p_watch);
	}
}

void ScatterLayer::set_value(
		const char *p_property, const Ref<ScatterValueSource> &p_value, Ref<ScatterValueSource> &r_current) {
	if (r_current == p_value) {
		return;
	}
	if (p_value.is_valid()) {
		const Ref<ScatterLayer> referenced = p_value->stored_layer();
		if (referenced.is_valid() && referenced->stores(this)) {
			ERR_PRINT(vformat("ScatterLayer.%s: %s", p_property, layer_cycle_problem));
			return;
		}
	}
	watch_values(false);
	r_current = p_value;
	watch_values(true);
	mark_changed();
}

void ScatterLayer::set_color_value(const Ref<ScatterValueSource> &p_value) {
	set_value("color_value", p_value, color_value_);
}

void ScatterLayer::set_variation_value(const Ref<ScatterValueSource> &p_value) {
	set_value("variation_value", p_value, variation_value_);
}

void ScatterLayer::set_scale_value(const Ref<ScatterValueSource> &p_value) {
	set_value("scale_value", p_value, scale_value_);
}

/// Sets a property of release 0.2 that is now part of a ScatterValueSource, and warns once. Returns
/// false for any other name.
bool ScatterLayer::set_former_value(const StringName &p_name, const Variant &p_value) {
	for (const FormerValue &value : former_values) {
		// Do not build a string before this check, because the engine calls this for every
		// property.
		if (p_name == StringName(value.former_name)) {
			const char *property = value.is_color ? "color_value" : "variation_value";
			const std::string prefix = "ScatterLayer.";
			warn_of_rename((prefix + value.former_name).c_str(), (prefix + property + "." + value.property).c_str());
			Ref<ScatterValueSource> &source = value.is_color ? color_value_ : variation_value_;
			if (source.is_null()) {
				set_value(property, Ref<ScatterValueSource>(memnew(ScatterValueSource)), source);
			}
			source->call("set", value.property, p_value);
			return true;
		}
	}
	return false;
}

void ScatterLayer::add_source_problems(PackedStringArray &r_problems) const {
	const InstanceData &data = settings_.instance_data;
	if (color_value_.is_valid()) {
		String unused;
		if (!data.use_colors) {
			unused = "is not used without use_colors. Enable use_colors, or clear color_value.";
		} else if (color_value_->get_gradient().is_null()) {
			unused = "has no gradient: all instances are white. Set a gradient, or clear color_value.";
		} else if (color_value_->get_gradient()->get_point_count() == 0) {
			unused = "has a gradient without points: all instances are black. Add points, or clear color_value.";
		}
		ValueProblems("color_value", *color_value_.ptr(), r_problems).add(unused);
	}
	if (variation_value_.is_valid()) {
		ValueProblems("variation_value", *variation_value_.ptr(), r_problems)
				.add(data.use_custom_data ? ""
										  : "is not used without use_custom_data. Enable use_custom_data, or clear "
											"variation_value.");
	}
	if (scale_value_.is_valid()) {
		const bool varies = settings_.placement.min_scale != settings_.placement.max_scale;
		ValueProblems("scale_value", *scale_value_.ptr(), r_problems)
				.add(varies ? ""
							: "has no effect because min_scale equals max_scale. Change one of them, or clear "
							  "scale_value.");
	}
}

void ScatterLayer::bind_scale_value() {
	bind_guarded<&ScatterLayer::set_scale_value>(D_METHOD("set_scale_value", "value"));
	bind_guarded<&ScatterLayer::get_scale_value>(D_METHOD("get_scale_value"));
	add_layer_property(PropertyUse::placement, value_property("scale_value"), "set_scale_value", "get_scale_value");
}

void ScatterLayer::bind_sources() {
	bind_switch<use_colors>();
	bind_guarded<&ScatterLayer::set_color_value>(D_METHOD("set_color_value", "value"));
	bind_guarded<&ScatterLayer::get_color_value>(D_METHOD("get_color_value"));
	add_layer_property(PropertyUse::placement, value_property("color_value"), "set_color_value", "get_color_value");
	bind_switch<use_custom_data>();
	bind_guarded<&ScatterLayer::set_variation_value>(D_METHOD("set_variation_value", "value"));
	bind_guarded<&ScatterLayer::get_variation_value>(D_METHOD("get_variation_value"));
	add_layer_property(
			PropertyUse::placement, value_property("variation_value"), "set_variation_value", "get_variation_value");
}

} // namespace thicket
