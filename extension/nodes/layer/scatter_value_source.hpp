#pragma once

#include "core/placement/instance_data.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/layer/reference_change.hpp"

#include <godot_cpp/classes/curve.hpp>
#include <godot_cpp/classes/gradient.hpp>
#include <godot_cpp/classes/noise.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <memory>

namespace thicket {

/// The source of an instance's color or variation, as a number from 0 to 1. Layers may share a
/// source. Emits `changed` when a property is set, and when its noise, gradient or curve changes.
class ScatterValueSource : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterValueSource, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// The values of SourceKind, for scripts.
	enum Source : std::int64_t {
		SOURCE_RANDOM,
		SOURCE_HEIGHT,
		SOURCE_SLOPE,
		SOURCE_NOISE,
		SOURCE_RANK,
		SOURCE_DISTANCE,
	};

	void set_source(Source p_source);
	Source get_source() const { return static_cast<Source>(values_.kind); }

	/// These setters set the range of source values that maps to 0 to 1, in the source's unit. The
	/// absolute value of each is at most max_source_value.
	void set_min_value(double p_value);
	double get_min_value() const { return values_.min; }
	void set_max_value(double p_value);
	double get_max_value() const { return values_.max; }

	/// Sets the random fraction of the number, 0 to 1.
	void set_randomness(double p_randomness);
	double get_randomness() const { return values_.randomness; }

	/// Sets the noise for SOURCE_NOISE.
	void set_noise(const godot::Ref<godot::Noise> &p_noise);
	godot::Ref<godot::Noise> get_noise() const { return noise_; }

	/// Sets the layer for SOURCE_DISTANCE: a ScatterLayer or its name. Null or "" means no layer. A
	/// layer that has a name is stored by name.
	void set_layer(const godot::Variant &p_layer);
	godot::Variant get_layer() const;

	/// Sets the colors for the numbers from 0 to 1. Null means white. The gradient has no effect on
	/// a variation.
	void set_gradient(const godot::Ref<godot::Gradient> &p_gradient);
	godot::Ref<godot::Gradient> get_gradient() const { return gradient_; }

	/// Sets a curve that maps the number to the final number. Null leaves the number unchanged.
	void set_curve(const godot::Ref<godot::Curve> &p_curve);
	godot::Ref<godot::Curve> get_curve() const { return curve_; }

	void noise_changed();
	void gradient_changed();
	void curve_changed();

	/// `current` returns the current settings without the layer, and `current_colors` the colors.
	/// The copy of the noise and the tables stay the same objects until their content changes.
	const InstanceSource &current();
	const std::shared_ptr<const ColorTable> &current_colors();

	/// Returns the layer in the form of stored_reference.
	const godot::Variant &stored_layer() const { return layer_; }

	void change_reference(const ReferenceChange &change);

	static constexpr const char *class_name = "ScatterValueSource";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	void set_number(const char *p_property, double p_value, double p_min, double p_max, double &r_value);
	template <class T>
	void set_content(const godot::Ref<T> &p_content, const char *p_change_method, godot::Ref<T> &r_current);

	InstanceSource values_;
	std::shared_ptr<const ColorTable> colors_;
	godot::Ref<godot::Noise> noise_;
	godot::Ref<godot::Gradient> gradient_;
	godot::Ref<godot::Curve> curve_;
	godot::Variant layer_ = godot::String();
	bool noise_is_new_ = false; ///< True if the copy of the noise is outdated.
	bool gradient_is_new_ = false;
	bool curve_is_new_ = false;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterValueSource::Source)
