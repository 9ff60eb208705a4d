// The sources of an instance's color and variation: the properties of the subgroups Color and Custom Data.

#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <memory>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *range_hint = "-1000,1000,0.001,or_less,or_greater"; // See _validate_property.
constexpr const char *randomness_hint = "0,1,0.001";

constexpr SwitchProperty use_colors{"use_colors", "is_using_colors", &InstanceData::use_colors};
constexpr ResourceProperty color_gradient{"color_gradient", &InstanceData::colors, color_table};
constexpr NumberProperty<ColorSource, SourceKind> color_source{
		"color_source", &ColorSource::kind, ScatterLayer::SOURCE_RANDOM, ScatterLayer::SOURCE_DISTANCE};
constexpr NumberProperty<ColorSource, double> color_source_min{
		"color_source_min", &ColorSource::min, -max_source_value, max_source_value, PROPERTY_HINT_RANGE, range_hint};
constexpr NumberProperty<ColorSource, double> color_source_max{
		"color_source_max", &ColorSource::max, -max_source_value, max_source_value, PROPERTY_HINT_RANGE, range_hint};
constexpr ResourceProperty<ColorSource, std::shared_ptr<const DensityField>, Noise> color_source_noise{
		"color_source_noise", &ColorSource::noise, plain_noise_field};
constexpr NumberProperty<ColorSource, double> color_randomness{
		"color_randomness", &ColorSource::randomness, 0.0, 1.0, PROPERTY_HINT_RANGE, randomness_hint};

constexpr SwitchProperty use_custom_data{"use_custom_data", "is_using_custom_data", &InstanceData::use_custom_data};
constexpr NumberProperty<VariationSource, SourceKind> variation_source{
		"variation_source", &VariationSource::kind, ScatterLayer::SOURCE_RANDOM, ScatterLayer::SOURCE_DISTANCE};
constexpr NumberProperty<VariationSource, double> variation_source_min{"variation_source_min", &VariationSource::min,
		-max_source_value, max_source_value, PROPERTY_HINT_RANGE, range_hint};
constexpr NumberProperty<VariationSource, double> variation_source_max{"variation_source_max", &VariationSource::max,
		-max_source_value, max_source_value, PROPERTY_HINT_RANGE, range_hint};
constexpr ResourceProperty<VariationSource, std::shared_ptr<const DensityField>, Noise> variation_source_noise{
		"variation_source_noise", &VariationSource::noise, plain_noise_field};
constexpr NumberProperty<VariationSource, double> variation_randomness{
		"variation_randomness", &VariationSource::randomness, 0.0, 1.0, PROPERTY_HINT_RANGE, randomness_hint};

PropertyInfo source_property(const char *p_name) {
	return PropertyInfo(Variant::INT, p_name, PROPERTY_HINT_ENUM, "Random,Height,Slope,Noise,Rank,Distance");
}

PropertyInfo layer_property(const char *p_name) {
	return PropertyInfo(
			Variant::NIL, p_name, PROPERTY_HINT_NONE, String(), PROPERTY_USAGE_DEFAULT | PROPERTY_USAGE_NIL_IS_VARIANT);
}

/// A source without the values that its kind does not use, so that changing those has no effect.
template <class Source>
Source used(const Source &source, bool is_used) {
	Source result;
	if (is_used && source.kind != SourceKind::random) {
		result = source;
	}
	if (source.kind != SourceKind::noise) {
		result.noise = nullptr;
	}
	return result;
}

/// The problems of one source.
class SourceProblems {
public:
	SourceProblems(const char *p_name, const InstanceSource &source, PackedStringArray &r_problems) :
			name_("ScatterLayer." + String(p_name)), source_(source), problems_(r_problems) {}

	/// `p_unused` explains why the source has no effect; empty if it has one.
	void add(const String &p_unused, bool has_noise, bool has_layer) {
		if (source_.kind != SourceKind::random && !p_unused.is_empty()) {
			problems_.push_back(name_ + String("_source ") + p_unused);
			return;
		}
		add_unused("_source_noise", has_noise, SourceKind::noise, "Noise");
		add_unused("_source_layer", has_layer, SourceKind::distance, "Distance");
		if (source_.kind == SourceKind::noise && !has_noise) {
			problems_.push_back(name_ + String("_source is Noise, but there is no noise: it is random."));
		}
		if (source_.kind == SourceKind::distance && !has_layer) {
			problems_.push_back(name_ + String("_source is Distance, but names no layer: it is random."));
		}
		if (source_.kind != SourceKind::random && source_.randomness >= 1.0) {
			problems_.push_back(name_ + String("_source has no effect: the randomness is 1."));
		}
		add_as_made(SourceKind::height, "meters of height");
		add_as_made(SourceKind::slope, "degrees of slope");
	}

private:
	void add_unused(const char *p_part, bool is_set, SourceKind kind, const char *p_kind) {
		if (is_set && source_.kind != kind) {
			problems_.push_back(
					name_ + String(p_part) + String(" is not used: the source is not ") + p_kind + String("."));
		}
	}

	/// A newly chosen source has a range of 0 to 1, whatever it measures.
	void add_as_made(SourceKind kind, const char *p_unit) {
		if (source_.kind == kind && source_.min == 0.0 && source_.max == 1.0) {
			problems_.push_back(name_ + String("_source goes over 0 to 1 ") + p_unit +
					String(", as it is made: set its minimum and maximum."));
		}
	}

	String name_;
	const InstanceSource &source_;
	PackedStringArray &problems_;
};

} // namespace

InstanceData ScatterLayer::instance_data() const {
	InstanceData result = settings_.instance_data;
	result.color = used(result.color, result.use_colors && result.colors != nullptr);
	result.variation = used(result.variation, result.use_custom_data);
	return result;
}

void ScatterLayer::set_color_source(ValueSource p_source) { set_integer<color_source>(p_source); }

ScatterLayer::ValueSource ScatterLayer::get_color_source() const {
	return static_cast<ValueSource>(get_integer<color_source>());
}

void ScatterLayer::set_color_source_layer(const Variant &p_layer) {
	set_reference("color_source_layer", p_layer, color_source_layer_, links_.color_layer);
}

Variant ScatterLayer::get_color_source_layer() const { return stored_reference(color_source_layer_); }

void ScatterLayer::set_variation_source(ValueSource p_source) { set_integer<variation_source>(p_source); }

ScatterLayer::ValueSource ScatterLayer::get_variation_source() const {
	return static_cast<ValueSource>(get_integer<variation_source>());
}

void ScatterLayer::set_variation_source_layer(const Variant &p_layer) {
	set_reference("variation_source_layer", p_layer, variation_source_layer_, links_.variation_layer);
}

Variant ScatterLayer::get_variation_source_layer() const { return stored_reference(variation_source_layer_); }

void ScatterLayer::add_source_problems(PackedStringArray &r_problems) const {
	const InstanceData &data = settings_.instance_data;
	String unused;
	if (!data.use_colors) {
		unused = "is not used without use_colors.";
	} else if (data.colors == nullptr) {
		unused = "is not used without color_gradient: all instances are white.";
	}
	SourceProblems("color", data.color, r_problems)
			.add(unused, resource("color_source_noise").is_valid(), !links_.color_layer.empty());
	SourceProblems("variation", data.variation, r_problems)
			.add(data.use_custom_data ? "" : "is not used without use_custom_data.",
					resource("variation_source_noise").is_valid(), !links_.variation_layer.empty());
}

void ScatterLayer::bind_sources() {
	bind_switch<use_colors>();
	ADD_SUBGROUP("Color", "color_");
	bind_resource<color_gradient>();
	bind_guarded<&ScatterLayer::set_color_source>(D_METHOD("set_color_source", "source"));
	bind_guarded<&ScatterLayer::get_color_source>(D_METHOD("get_color_source"));
	add_layer_property(PropertyUse::placement, source_property("color_source"), "set_color_source", "get_color_source");
	bind_guarded<&ScatterLayer::set_color_source_layer>(D_METHOD("set_color_source_layer", "layer"));
	bind_guarded<&ScatterLayer::get_color_source_layer>(D_METHOD("get_color_source_layer"));
	add_layer_property(PropertyUse::placement, layer_property("color_source_layer"), "set_color_source_layer",
			"get_color_source_layer");
	bind_resource<color_source_noise>();
	bind_number<color_source_min>();
	bind_number<color_source_max>();
	bind_number<color_randomness>();
	bind_switch<use_custom_data>();
	ADD_SUBGROUP("Variation", "variation_");
	bind_guarded<&ScatterLayer::set_variation_source>(D_METHOD("set_variation_source", "source"));
	bind_guarded<&ScatterLayer::get_variation_source>(D_METHOD("get_variation_source"));
	add_layer_property(PropertyUse::placement, source_property("variation_source"), "set_variation_source",
			"get_variation_source");
	bind_guarded<&ScatterLayer::set_variation_source_layer>(D_METHOD("set_variation_source_layer", "layer"));
	bind_guarded<&ScatterLayer::get_variation_source_layer>(D_METHOD("get_variation_source_layer"));
	add_layer_property(PropertyUse::placement, layer_property("variation_source_layer"), "set_variation_source_layer",
			"get_variation_source_layer");
	bind_resource<variation_source_noise>();
	bind_number<variation_source_min>();
	bind_number<variation_source_max>();
	bind_number<variation_randomness>();
	BIND_ENUM_CONSTANT(SOURCE_RANDOM);
	BIND_ENUM_CONSTANT(SOURCE_HEIGHT);
	BIND_ENUM_CONSTANT(SOURCE_SLOPE);
	BIND_ENUM_CONSTANT(SOURCE_NOISE);
	BIND_ENUM_CONSTANT(SOURCE_RANK);
	BIND_ENUM_CONSTANT(SOURCE_DISTANCE);
}

} // namespace thicket
