#include "nodes/layer/scatter_value_source.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/common/watch.hpp"
#include "nodes/layer/field_sources.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/object.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns the hint string for min_value and max_value in the inspector.
const char *range_hint(SourceKind kind) {
	switch (kind) {
		case SourceKind::height: return "-1000,9000,0.1,or_less,or_greater,suffix:m";
		case SourceKind::slope: return "0,90,0.1,degrees";
		case SourceKind::distance: return "0,200,0.01,or_greater,suffix:m";
		default: return "0,1,0.001";
	}
}

} // namespace

void ScatterValueSource::set_source(Source p_source) {
	const auto kind = static_cast<SourceKind>(p_source);
	if (accept_number(class_name, "source", static_cast<double>(p_source), SOURCE_RANDOM, SOURCE_DISTANCE) &&
			values_.kind != kind) {
		values_.kind = kind;
		notify_property_list_changed();
		emit_changed();
	}
}

void ScatterValueSource::set_number(
		const char *p_property, double p_value, double p_min, double p_max, double &r_value) {
	if (accept_number(class_name, p_property, p_value, p_min, p_max) && r_value != p_value) {
		r_value = p_value;
		emit_changed();
	}
}

void ScatterValueSource::set_min_value(double p_value) {
	set_number("min_value", p_value, -max_source_value, max_source_value, values_.min);
}

void ScatterValueSource::set_max_value(double p_value) {
	set_number("max_value", p_value, -max_source_value, max_source_value, values_.max);
}

void ScatterValueSource::set_randomness(double p_randomness) {
	set_number("randomness", p_randomness, 0.0, 1.0, values_.randomness);
}

/// Sets a resource. `p_change_method` is the method to call when the resource changes.
template <class T>
void ScatterValueSource::set_content(const Ref<T> &p_content, const char *p_change_method, Ref<T> &r_current) {
	if (r_current == p_content) {
		return;
	}
	watch(r_current.ptr(), "changed", this, p_change_method, false);
	r_current = p_content;
	watch(r_current.ptr(), "changed", this, p_change_method, true);
	notify_property_list_changed();
	call(p_change_method);
}

void ScatterValueSource::set_noise(const Ref<Noise> &p_noise) { set_content(p_noise, "_noise_changed", noise_); }

void ScatterValueSource::set_gradient(const Ref<Gradient> &p_gradient) {
	set_content(p_gradient, "_gradient_changed", gradient_);
}

void ScatterValueSource::set_curve(const Ref<Curve> &p_curve) { set_content(p_curve, "_curve_changed", curve_); }

void ScatterValueSource::noise_changed() {
	noise_is_new_ = true;
	emit_changed();
}

void ScatterValueSource::gradient_changed() {
	gradient_is_new_ = true;
	emit_changed();
}

void ScatterValueSource::curve_changed() {
	curve_is_new_ = true;
	emit_changed();
}

void ScatterValueSource::set_layer(const Variant &p_layer) {
	Variant reference = String();
	if (p_layer.get_type() != Variant::NIL) {
		reference = accept_reference("ScatterValueSource.layer", p_layer, this);
	}
	if (reference.get_type() != Variant::NIL && core_reference(reference) != core_reference(layer_)) {
		layer_ = reference;
		notify_property_list_changed();
		emit_changed();
	}
}

Variant ScatterValueSource::get_layer() const { return stored_reference(layer_); }

const InstanceSource &ScatterValueSource::current() {
	if (std::exchange(noise_is_new_, false)) {
		values_.noise = plain_noise_field(noise_);
	}
	if (std::exchange(curve_is_new_, false)) {
		values_.curve = curve_table(curve_);
	}
	return values_;
}

const std::shared_ptr<const ColorTable> &ScatterValueSource::current_colors() {
	if (std::exchange(gradient_is_new_, false)) {
		colors_ = color_table(gradient_);
	}
	return colors_;
}

void ScatterValueSource::change_reference(const ReferenceChange &change) {
	if (const auto new_reference = changed_reference(change, "ScatterValueSource.layer", layer_, this)) {
		set_layer(*new_reference);
	}
}

/// Hides properties that do not apply to the source. A property that is set stays visible, because
/// a warning mentions it.
void ScatterValueSource::_validate_property(PropertyInfo &p_property) const {
	const bool is_random = values_.kind == SourceKind::random;
	const auto hide = [&p_property](const char *p_name, bool p_hidden) {
		if (p_hidden && p_property.name == StringName(p_name)) {
			p_property.usage &= ~static_cast<std::uint32_t>(PROPERTY_USAGE_EDITOR);
		}
	};
	for (const char *name : {"min_value", "max_value", "randomness"}) {
		hide(name, is_random);
	}
	hide("noise", values_.kind != SourceKind::noise && noise_.is_null());
	hide("layer", values_.kind != SourceKind::distance && core_reference(layer_).empty());
	if (p_property.name == StringName("min_value") || p_property.name == StringName("max_value")) {
		p_property.hint_string = range_hint(values_.kind);
	}
}

void ScatterValueSource::_bind_methods() {
	using Self = ScatterValueSource;
	// The range accepts any number, as described at _validate_property.
	constexpr const char *any_range = "-1000,1000,0.001,or_less,or_greater";
	bind_guarded<&Self::set_source>(D_METHOD("set_source", "source"));
	bind_guarded<&Self::get_source>(D_METHOD("get_source"));
	bind_guarded<&Self::set_min_value>(D_METHOD("set_min_value", "value"));
	bind_guarded<&Self::get_min_value>(D_METHOD("get_min_value"));
	bind_guarded<&Self::set_max_value>(D_METHOD("set_max_value", "value"));
	bind_guarded<&Self::get_max_value>(D_METHOD("get_max_value"));
	bind_guarded<&Self::set_randomness>(D_METHOD("set_randomness", "randomness"));
	bind_guarded<&Self::get_randomness>(D_METHOD("get_randomness"));
	bind_guarded<&Self::set_noise>(D_METHOD("set_noise", "noise"));
	bind_guarded<&Self::get_noise>(D_METHOD("get_noise"));
	bind_guarded<&Self::set_layer>(D_METHOD("set_layer", "layer"));
	bind_guarded<&Self::get_layer>(D_METHOD("get_layer"));
	bind_guarded<&Self::set_gradient>(D_METHOD("set_gradient", "gradient"));
	bind_guarded<&Self::get_gradient>(D_METHOD("get_gradient"));
	bind_guarded<&Self::set_curve>(D_METHOD("set_curve", "curve"));
	bind_guarded<&Self::get_curve>(D_METHOD("get_curve"));
	bind_guarded<&Self::noise_changed>(ThreadUse::relayed, D_METHOD("_noise_changed"));
	bind_guarded<&Self::gradient_changed>(ThreadUse::relayed, D_METHOD("_gradient_changed"));
	bind_guarded<&Self::curve_changed>(ThreadUse::relayed, D_METHOD("_curve_changed"));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "source", PROPERTY_HINT_ENUM, "Random,Height,Slope,Noise,Rank,Distance"),
			"set_source", "get_source");
	ADD_PROPERTY(
			PropertyInfo(Variant::OBJECT, "noise", PROPERTY_HINT_RESOURCE_TYPE, "Noise"), "set_noise", "get_noise");
	ADD_PROPERTY(PropertyInfo(Variant::NIL, "layer", PROPERTY_HINT_NONE, String(),
						 PROPERTY_USAGE_DEFAULT | PROPERTY_USAGE_NIL_IS_VARIANT),
			"set_layer", "get_layer");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "min_value", PROPERTY_HINT_RANGE, any_range), "set_min_value",
			"get_min_value");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "max_value", PROPERTY_HINT_RANGE, any_range), "set_max_value",
			"get_max_value");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "randomness", PROPERTY_HINT_RANGE, "0,1,0.001"), "set_randomness",
			"get_randomness");
	ADD_PROPERTY(
			PropertyInfo(Variant::OBJECT, "curve", PROPERTY_HINT_RESOURCE_TYPE, "Curve"), "set_curve", "get_curve");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "gradient", PROPERTY_HINT_RESOURCE_TYPE, "Gradient"), "set_gradient",
			"get_gradient");
	BIND_ENUM_CONSTANT(SOURCE_RANDOM);
	BIND_ENUM_CONSTANT(SOURCE_HEIGHT);
	BIND_ENUM_CONSTANT(SOURCE_SLOPE);
	BIND_ENUM_CONSTANT(SOURCE_NOISE);
	BIND_ENUM_CONSTANT(SOURCE_RANK);
	BIND_ENUM_CONSTANT(SOURCE_DISTANCE);
}

} // namespace thicket
