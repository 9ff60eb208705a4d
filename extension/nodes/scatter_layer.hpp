#pragma once

#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/property_check.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// The numbers of a layer, as the inspector shows them. Angles in degrees, lengths in metres.
struct LayerNumbers {
	double radius = 2.0;
	double tile_size = 64.0;
	double view_distance = 256.0;
	double density = 1.0;
	double min_slope_degrees = 0.0;
	double max_slope_degrees = 90.0;
	double slope_falloff = 0.0;
	double min_height = -unlimited_height;
	double max_height = unlimited_height;
	double height_falloff = 0.0;
	double min_yaw_degrees = 0.0;
	double max_yaw_degrees = 360.0;
	double min_scale = 1.0;
	double max_scale = 1.0;
	double align_to_normal = 0.0;
	double height_offset = 0.0;
	double lod_bias = 1.0;
	double extra_cull_margin = 0.0;
	double visibility_range_begin = 0.0;
	double visibility_range_begin_margin = 0.0;
	double visibility_range_end = 0.0;
	double visibility_range_end_margin = 0.0;
};

/// The whole numbers of a layer. Enumerations hold the engine's values.
struct LayerIntegers {
	int64_t layer_id = -1;
	int64_t levels = 1;
	int64_t cast_shadow = 1;                ///< GeometryInstance3D.ShadowCastingSetting.
	int64_t gi_mode = 1;                    ///< GeometryInstance3D.GIMode.
	int64_t layers = 1;                     ///< Render layers, a mask of 20 bits.
	int64_t visibility_range_fade_mode = 0; ///< GeometryInstance3D.VisibilityRangeFadeMode.
};

/// One species or family, placed by one rule set: what stands where, and how it is drawn. Settings only.
///
/// A setter refuses what is not finite or out of range: one error that names the property and the value, and the value
/// stays. A minimum above its maximum is found when the layer is used, so that both may be set in any order; the error
/// comes then, and what stands stays.
class ScatterLayer : public godot::Resource {
	GDCLASS(ScatterLayer, godot::Resource)

public:
	template <const NumberProperty<LayerNumbers, double> &property>
	void set_number(double p_value);
	template <const NumberProperty<LayerNumbers, double> &property>
	double get_number() const;
	template <const NumberProperty<LayerIntegers, int64_t> &property>
	void set_integer(int64_t p_value);
	template <const NumberProperty<LayerIntegers, int64_t> &property>
	int64_t get_integer() const;

	/// What may stand at a point; null entries draw nothing.
	void set_meshes(const godot::TypedArray<godot::Mesh> &p_meshes);
	godot::TypedArray<godot::Mesh> get_meshes() const;

	/// Chances of the meshes, in proportion; missing ones count as 1.
	void set_mesh_weights(const godot::PackedFloat32Array &p_weights);
	godot::PackedFloat32Array get_mesh_weights() const;

	void set_material_override(const godot::Ref<godot::Material> &p_material);
	godot::Ref<godot::Material> get_material_override() const;

	/// The settings that the core works with. `place` is the layer's index among its node's layers: its id, unless
	/// `layer_id` says otherwise.
	LayerSettings settings(std::uint64_t seed, std::size_t place) const;
	StreamLayer streaming() const;
	const LayerNumbers &numbers() const { return numbers_; }
	const LayerIntegers &integers() const { return integers_; }

	/// The meshes, null entries included; at least as many as `settings` has weights for.
	std::vector<godot::Ref<godot::Mesh>> mesh_list() const;

	/// Refuses what the core would refuse, and tiles of more than max_tile_points points.
	Status check() const;

	/// What is likely not meant, for the editor's warnings.
	godot::PackedStringArray problems() const;

	static constexpr double max_tile_points = 4e6;

protected:
	static void _bind_methods();

private:
	Rules core_rules() const;
	void watch_meshes(bool p_watch);
	template <const NumberProperty<LayerNumbers, double> &property>
	static void bind_number();
	template <const NumberProperty<LayerIntegers, int64_t> &property>
	static void bind_integer();
	static void bind_placing();
	static void bind_drawing();

	LayerNumbers numbers_;
	LayerIntegers integers_;
	godot::TypedArray<godot::Mesh> meshes_;
	godot::PackedFloat32Array mesh_weights_;
	godot::Ref<godot::Material> material_override_;
};

} // namespace thicket
