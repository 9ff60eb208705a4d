#pragma once

#include "core/placement/lod.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/layer/layer_snapshots.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/layer/scatter_mask.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/physics_material.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/typed_dictionary.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace thicket {

/// The numbers of a layer, as the inspector shows them. Angles in degrees, lengths in meters.
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
	double clump_size = 0.0;
	double clump_coverage = 0.5;
	double clump_softness = 0.25;
	double edge_feather = 0.0;
	double proximity_distance = 5.0;
	double min_yaw_degrees = 0.0;
	double max_yaw_degrees = 360.0;
	double min_tilt_degrees = 0.0;
	double max_tilt_degrees = 0.0;
	double min_scale = 1.0;
	double max_scale = 1.0;
	double align_to_normal = 0.0;
	double height_offset = 0.0;
	double offset_along_normal = 0.0;
	double lod_bias = 1.0;
	double extra_cull_margin = 0.0;
	double visibility_range_begin = 0.0;
	double visibility_range_begin_margin = 0.0;
	double visibility_range_end = 0.0;
	double visibility_range_end_margin = 0.0;
	double thin_begin = 0.0;
	double thin_end = 0.0;
	double thin_density = 1.0;
	double instance_radius = 0.5;
	double instance_height = 2.0;
	double regrowth_time = 0.0; ///< Seconds.
	double collision_distance = 40.0;
	double scene_distance = 20.0;
};

/// The whole numbers of a layer. Enumerations hold the engine's values, or ours.
struct LayerIntegers {
	int64_t layer_id = -1;
	int64_t levels = 1;
	int64_t mask_texture_channel = 0;       ///< ImageChannel.
	int64_t mask_texture_edge = 0;          ///< MaskEdge.
	int64_t cast_shadow = 1;                ///< GeometryInstance3D.ShadowCastingSetting.
	int64_t gi_mode = 1;                    ///< GeometryInstance3D.GIMode.
	int64_t layers = 1;                     ///< Render layers, a mask of 20 bits.
	int64_t visibility_range_fade_mode = 0; ///< GeometryInstance3D.VisibilityRangeFadeMode.
	int64_t collision_shape = 0;            ///< ScatterLayer::CollisionShape.
	int64_t collision_layer = 1;            ///< Physics layers, a mask of 32 bits.
	int64_t collision_mask = 1;             ///< Likewise.
};

/// What a layer has or has not.
struct LayerSwitches {
	bool use_colors = false;
	bool use_custom_data = false;
	bool thin_scale_compensation = false;
};

/// A resource among a layer's properties, as NumberProperty is a number.
template <class T>
struct ResourceProperty {
	const char *name;
	const char *type; ///< What the inspector offers.
	godot::Ref<T> LayerResources::*member;
	LayerSource source;
};

/// A switch among a layer's properties.
struct SwitchProperty {
	const char *name;
	bool LayerSwitches::*member;
};

/// One species or family, placed by one rule set: what stands where, and how it is drawn. Settings only.
///
/// A setter refuses what is not finite or out of range: one error that names the property and the value, and the value
/// stays. A minimum above its maximum is found when the layer is used, so that both may be set in any order; the error
/// comes then, and what stands stays.
///
/// `changed` is emitted by every setter, and whenever one of the layer's own resources emits it. Only what is painted on the
/// mask comes as `area_changed`, with the rectangle of the world outside which the mask is as it was.
class ScatterLayer : public godot::Resource {
	GDCLASS(ScatterLayer, godot::Resource)

public:
	/// ImageChannel, for scripts.
	enum MaskChannel : std::int64_t {
		MASK_CHANNEL_RED,
		MASK_CHANNEL_GREEN,
		MASK_CHANNEL_BLUE,
		MASK_CHANNEL_ALPHA,
		MASK_CHANNEL_LUMINANCE,
	};

	/// MaskEdge, for scripts.
	enum MaskTextureEdge : std::int64_t {
		MASK_EDGE_NOTHING,
		MASK_EDGE_EVERYTHING,
		MASK_EDGE_CLAMP,
		MASK_EDGE_REPEAT,
	};

	/// What bodies meet of an instance that is near. Of instance_radius and instance_height, but for the last.
	enum CollisionShape : std::int64_t {
		COLLISION_NONE,
		COLLISION_CAPSULE,
		COLLISION_CYLINDER,
		COLLISION_BOX,
		COLLISION_CONVEX, ///< The convex hull of the instance's mesh.
	};

	// The properties that scatter_layer_properties.hpp makes of one line each.
	template <const NumberProperty<LayerNumbers, double> &property>
	void set_number(double p_value);
	template <const NumberProperty<LayerNumbers, double> &property>
	double get_number() const;
	template <const NumberProperty<LayerIntegers, int64_t> &property>
	void set_integer(int64_t p_value);
	template <const NumberProperty<LayerIntegers, int64_t> &property>
	int64_t get_integer() const;
	template <const SwitchProperty &property>
	void set_switch(bool p_value);
	template <const SwitchProperty &property>
	bool get_switch() const;
	template <class T, const ResourceProperty<T> &property>
	void set_resource(const godot::Ref<T> &p_resource);
	template <class T, const ResourceProperty<T> &property>
	godot::Ref<T> get_resource() const;
	template <class T, const ResourceProperty<T> &property>
	void resource_changed();

	/// A painted density; null for none. Layers may share it.
	void set_mask(const godot::Ref<ScatterMask> &p_mask);
	godot::Ref<ScatterMask> get_mask() const;
	void mask_area_changed(const godot::Rect2 &p_rect);

	/// World meters that the mask texture covers: x, and z as y. Its sides are at least 0.001.
	void set_mask_texture_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_mask_texture_rect() const;
	void set_mask_texture_channel(MaskChannel p_channel);
	MaskChannel get_mask_texture_channel() const;
	void set_mask_texture_edge(MaskTextureEdge p_edge);
	MaskTextureEdge get_mask_texture_edge() const;

	/// The terrain's textures that the layer stands on, 0 to max_texture each; none for any ground.
	void set_ground_textures(const godot::PackedInt32Array &p_textures);
	godot::PackedInt32Array get_ground_textures() const;

	/// Names of other layers, and the meters that are kept free around their instances: above 0, at most
	/// max_neighbor_distance; at most max_neighbors names. What is read back is read-only.
	void set_spacing(const godot::TypedDictionary<godot::String, double> &p_spacing);
	godot::TypedDictionary<godot::String, double> get_spacing() const;

	/// The layer whose instances are asked for; "" for none.
	void set_proximity_layer(const godot::String &p_name);
	godot::String get_proximity_layer() const;

	/// What may stand at a point; null entries draw nothing.
	void set_meshes(const godot::TypedArray<godot::Mesh> &p_meshes);
	godot::TypedArray<godot::Mesh> get_meshes() const;

	/// Chances of the meshes, in proportion; missing ones count as 1.
	void set_mesh_weights(const godot::PackedFloat32Array &p_weights);
	godot::PackedFloat32Array get_mesh_weights() const;

	void set_material_override(const godot::Ref<godot::Material> &p_material);
	godot::Ref<godot::Material> get_material_override() const;

	/// What is drawn in place of the meshes from each of the lod distances on: a row of entries for the meshes, then the row of
	/// the next distance. Null for the finer mesh; at most max_lods rows of max_meshes.
	void set_lod_meshes(const godot::TypedArray<godot::Mesh> &p_meshes);
	godot::TypedArray<godot::Mesh> get_lod_meshes() const;

	/// Meters from a viewer to a tile's box, ascending, 0 to 1e6 each; at most max_lods.
	void set_lod_distances(const godot::PackedFloat32Array &p_distances);
	godot::PackedFloat32Array get_lod_distances() const;

	void set_collision_shape(CollisionShape p_shape);
	CollisionShape get_collision_shape() const;

	/// Friction and bounce of the bodies; null for the engine's own.
	void set_physics_material(const godot::Ref<godot::PhysicsMaterial> &p_material);
	godot::Ref<godot::PhysicsMaterial> get_physics_material() const;

	/// What stands in place of the mesh near viewers; null for the mesh everywhere.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const;

	/// The settings that the core works with, all but the neighbors and the shapes, which are the node's. `place` is the
	/// layer's index among its node's layers: its id, unless `layer_id` says otherwise. A table, a field or a mask in it is
	/// the same object as in the settings before until what it says has changed.
	LayerSettings settings(std::uint64_t seed, std::size_t place) const;
	StreamLayer streaming() const;
	const LayerNumbers &numbers() const { return numbers_; }
	const LayerIntegers &integers() const { return integers_; }

	/// Other layers by their names, and the meters kept free around their instances.
	const std::map<std::string, double> &spacing() const { return spacing_; }

	/// The layer whose instances decide about this one's density; empty for none. They count up to the distance, in meters,
	/// and the table, which is never null, is the density over the distance to the nearest.
	std::string proximity_layer() const { return proximity_layer_.utf8().get_data(); }
	double proximity_distance() const { return numbers_.proximity_distance; }
	std::shared_ptr<const CurveTable> proximity_table() const;

	/// The meshes, null entries included; at least as many as `settings` has weights for.
	std::vector<godot::Ref<godot::Mesh>> mesh_list() const;

	/// The meshes for the distance, whole rows of them only, null entries included.
	std::vector<godot::Ref<godot::Mesh>> lod_mesh_list() const;
	LodSettings detail() const;

	/// Refuses what the core would refuse, and tiles of more than max_tile_points points.
	Status check() const;

	/// What is likely not meant, for the editor's warnings.
	godot::PackedStringArray problems() const;

	static constexpr double max_tile_points = 4e6;
	static constexpr std::int32_t max_texture = 255;

protected:
	static void _bind_methods();

private:
	using Number = NumberProperty<LayerNumbers, double>;
	using Integer = NumberProperty<LayerIntegers, int64_t>;

	Rules core_rules() const;
	Placement core_placement() const;
	InstanceData instance_data() const;
	const LayerSnapshots &snapshots() const;
	void watch_meshes(bool p_watch);
	void watch_mask(bool p_watch);
	bool accept_spacing(const godot::TypedDictionary<godot::String, double> &p_spacing) const;

	void add_number_problems(godot::PackedStringArray &r_problems) const;
	void add_curve_problems(godot::PackedStringArray &r_problems) const;
	void add_mask_problems(godot::PackedStringArray &r_problems) const;
	void add_neighbor_problems(godot::PackedStringArray &r_problems) const;
	void add_lod_problems(godot::PackedStringArray &r_problems) const;
	void add_mesh_problems(godot::PackedStringArray &r_problems) const;
	void add_gameplay_problems(godot::PackedStringArray &r_problems) const;

	template <const Number &property>
	static void bind_number();
	template <const Integer &property>
	static void bind_integer();
	template <const SwitchProperty &property>
	static void bind_switch();
	template <class T, const ResourceProperty<T> &property>
	static void bind_resource();
	static void bind_set();
	static void bind_rules();
	static void bind_masks();
	static void bind_neighbors();
	static void bind_placement();
	static void bind_drawing();
	static void bind_lod();
	static void bind_gameplay();

	LayerNumbers numbers_;
	LayerIntegers integers_;
	LayerSwitches switches_;
	LayerResources resources_;
	mutable LayerSnapshots snapshots_;

	godot::Ref<ScatterMask> mask_;
	godot::Rect2 mask_texture_rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	godot::PackedInt32Array ground_textures_;
	godot::TypedDictionary<godot::String, double> spacing_property_; ///< Read-only.
	std::map<std::string, double> spacing_;
	godot::String proximity_layer_;

	godot::TypedArray<godot::Mesh> meshes_;
	godot::PackedFloat32Array mesh_weights_;
	godot::TypedArray<godot::Mesh> lod_meshes_;
	godot::PackedFloat32Array lod_distances_;
	godot::Ref<godot::Material> material_override_;

	godot::Ref<godot::PhysicsMaterial> physics_material_;
	godot::Ref<godot::PackedScene> scene_;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskChannel)
VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskTextureEdge)
VARIANT_ENUM_CAST(thicket::ScatterLayer::CollisionShape)
