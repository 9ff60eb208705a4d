#pragma once

#include "core/placement/mesh_choice.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/layer/former_drawing.hpp"
#include "nodes/layer/layer_meshes.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/layer/layer_tables.hpp"
#include "nodes/layer/reference_change.hpp"
#include "nodes/layer/scatter_mask.hpp"
#include "nodes/layer/scatter_value_source.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/packed_scene.hpp>
#include <godot_cpp/classes/physics_material.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace thicket {

/// Properties of a ScatterLayer that belong to no part of its snapshot.
struct LayerIdentity {
	std::int64_t layer_id = -1; ///< -1 until a node has given the layer an ID.
};

class ScatterLayer;

/// Describes a property that is a resource, as NumberProperty describes a number. `make` converts the resource to a
/// table when a snapshot first needs it. `member` is where the table is stored, in one of the parts that
/// ScatterLayer::part finds. The inspector offers the class of `make`'s argument.
template <class Values, class Made, class T>
struct ResourceProperty {
	using Resource = T;

	const char *name;
	Made Values::*member;
	Made (*make)(const godot::Ref<T> &);
};

template <class Values, class Made, class T>
ResourceProperty(const char *, Made Values::*, Made (*)(const godot::Ref<T> &)) -> ResourceProperty<Values, Made, T>;

template <const auto &property>
using ResourceOf = typename std::remove_cvref_t<decltype(property)>::Resource;

/// The value of such a property.
struct LayerResource {
	godot::Ref<godot::Resource> value;
	void (ScatterLayer::*remake)() = nullptr; ///< Rebuilds its table; null while the table is up to date.
};

/// A boolean property of a layer, stored in one of the parts that ScatterLayer::part finds.
template <class Values>
struct SwitchProperty {
	const char *name;
	const char *getter; ///< "is_using_colors" and the like, in the engine's naming style.
	bool Values::*member;
};

template <class Values>
SwitchProperty(const char *, const char *, bool Values::*) -> SwitchProperty<Values>;

/// One species or family with its placement rules, and how it is drawn. Contains settings only.
///
/// A setter refuses values that are not finite or out of range: it prints one error that names the property and the value, and keeps the
/// old value. A minimum above its maximum is detected when the layer is used, so that both may be set in any order. The error is printed
/// then, and existing instances stay.
///
/// Every setter emits `changed`. A `changed` of one of its own resources also makes the layer emit it. Only painting on
/// the mask emits `area_changed` instead, with a rectangle of the world that contains all changes of the mask.
class ScatterLayer : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterLayer, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterLayer";

	/// ImageChannel, for scripts.
	enum MaskChannel : std::int64_t {
		MASK_CHANNEL_RED,
		MASK_CHANNEL_GREEN,
		MASK_CHANNEL_BLUE,
		MASK_CHANNEL_ALPHA,
		MASK_CHANNEL_LUMINANCE,
	};

	/// MaskEdge, for scripts.
	enum MaskEdge : std::int64_t {
		MASK_EDGE_NOTHING,
		MASK_EDGE_EVERYTHING,
		MASK_EDGE_CLAMP,
		MASK_EDGE_REPEAT,
	};

	/// BodyShape, for scripts: the collision shape of an instance near a viewer. All but the last are built from
	/// instance_radius and instance_height.
	enum CollisionShape : std::int64_t {
		COLLISION_NONE,
		COLLISION_CAPSULE,
		COLLISION_CYLINDER,
		COLLISION_BOX,
		COLLISION_CONVEX, ///< The convex hull of the instance's mesh.
		COLLISION_MODEL,  ///< The shapes of the instance's model.
	};

	/// What the meshes of a layer are, for fit_to_meshes.
	enum ModelKind : std::int64_t {
		KIND_AUTOMATIC, ///< Judged by their size; see kind_of.
		KIND_TREE,
		KIND_SHRUB,
		KIND_GRASS,
		KIND_ROCK,
	};

	// The accessors of properties. scatter_layer_properties.hpp defines each with one line.
	template <const auto &property>
	void set_number(double p_value);
	template <const auto &property>
	double get_number() const;
	template <const auto &property>
	void set_integer(int64_t p_value);
	template <const auto &property>
	int64_t get_integer() const;
	template <const auto &property>
	void set_switch(bool p_value);
	template <const auto &property>
	bool get_switch() const;
	template <const auto &property>
	void set_resource(const godot::Ref<ResourceOf<property>> &p_resource);
	template <const auto &property>
	godot::Ref<ResourceOf<property>> get_resource() const;
	template <const auto &property>
	void resource_changed();

	ScatterLayer();

	/// A painted density; null if there is none. Layers may share it.
	void set_mask(const godot::Ref<ScatterMask> &p_mask);
	godot::Ref<ScatterMask> get_mask() const;
	void mask_area_changed(const godot::Rect2 &p_rect);

	/// The area that the mask texture covers, in world meters: x, and z as y. Each side is at least 0.001.
	void set_mask_texture_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_mask_texture_rect() const;
	void set_mask_texture_channel(MaskChannel p_channel);
	MaskChannel get_mask_texture_channel() const;
	void set_mask_texture_edge(MaskEdge p_edge);
	MaskEdge get_mask_texture_edge() const;

	/// The ground's textures on which the layer grows, 0 to max_texture each; empty for all ground.
	void set_ground_textures(const godot::PackedInt32Array &p_textures);
	godot::PackedInt32Array get_ground_textures() const;

	/// Other layers, each as a ScatterLayer, its name or its index. Each has a distance in meters to keep free around
	/// its instances: 0.001 to max_neighbor_distance. At most max_neighbors layers. A layer that has a name is stored
	/// by name. The returned Dictionary is read-only.
	void set_spacing(const godot::Dictionary &p_spacing);
	godot::Dictionary get_spacing() const;

	/// The layer whose instances determine the density of this one: a ScatterLayer, its name or its index; null or ""
	/// for no layer.
	void set_proximity_layer(const godot::Variant &p_layer);
	godot::Variant get_proximity_layer() const;

	/// The meshes, scenes and models to draw at the points. Null entries draw nothing. See LayerMeshes for refused entries.
	void set_meshes(const godot::Array &p_meshes);
	godot::Array get_meshes() const;

	/// Scripts share the list that `get_meshes` returns. `meshes_differ` returns whether a script has changed it in
	/// place. `take_mesh_changes` applies the change as `set_meshes` would, or restores the previous list if the change
	/// is refused.
	bool meshes_differ() const { return meshes_.differs(); }
	void take_mesh_changes();

	/// Reads the next part of the scenes and models in `meshes`; see LayerMeshes. Snapshots and other users of meshes
	/// only see the parts that are already read.
	bool read_step();

	/// Rereads the scenes with these paths in `meshes`, because their files have changed.
	void reload_scenes(const godot::PackedStringArray &p_paths);

	/// Sets the properties that follow from the size and the kind of `meshes`: see get_fitted_properties and fit_of; collision_shape only if a
	/// model has shapes. Returns false and sets nothing if there are no meshes.
	bool fit_to_meshes(ModelKind p_kind = KIND_AUTOMATIC);

	/// The kind that the size of `meshes` suggests; KIND_AUTOMATIC if there are none.
	ModelKind get_model_kind();

	/// The properties that fit_to_meshes sets.
	godot::PackedStringArray get_fitted_properties() const;

	/// The relative frequency of each of the meshes, 0 to 1e6; missing entries count as 1.
	void set_mesh_weights(const godot::PackedFloat32Array &p_weights);
	godot::PackedFloat32Array get_mesh_weights() const;

	void set_material_override(const godot::Ref<godot::Material> &p_material);
	godot::Ref<godot::Material> get_material_override() const;

	/// The materials that instances are drawn with, without duplicates; see materials_of.
	godot::TypedArray<godot::Material> get_materials();

	/// The values of the properties that GeometryInstance3D has as well, by their names there.
	godot::Dictionary get_geometry_properties() const;

	/// The values that an instance's color on the gradient and its variation follow; null for random numbers. Layers
	/// may share them.
	void set_color_value(const godot::Ref<ScatterValueSource> &p_value);
	godot::Ref<ScatterValueSource> get_color_value() const { return color_value_; }
	void set_variation_value(const godot::Ref<ScatterValueSource> &p_value);
	godot::Ref<ScatterValueSource> get_variation_value() const { return variation_value_; }

	/// All LODs of an entry of `meshes`, the finest first, with every default replaced by its value. Empty for an entry
	/// that draws nothing. Prints an error for an invalid index.
	godot::TypedArray<ScatterLod> get_mesh_lods(int64_t p_index);

	void set_collision_shape(CollisionShape p_shape);
	CollisionShape get_collision_shape() const;

	/// Friction and bounce of the bodies; null for the engine's defaults.
	void set_physics_material(const godot::Ref<godot::PhysicsMaterial> &p_material);
	godot::Ref<godot::PhysicsMaterial> get_physics_material() const;

	/// Replaces the mesh near viewers; null to keep the mesh everywhere.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const;

	/// True if a property affects where instances are placed. False if it only affects how instances are drawn, or how
	/// a game interacts with them: see PropertyUse.
	bool affects_placement(const godot::StringName &p_property) const;

	/// The columns of ScatterTile.get_rows for the layer: the type of each column, by its name.
	godot::Dictionary get_row_columns() const;

	/// free_layer_name, for scripts.
	godot::String find_free_name(const godot::String &p_name, const godot::PackedStringArray &p_taken) const;

	/// The average number of points of the layer's set per square meter, before any rule applies.
	double get_point_density() const;

	/// Stores the data that the layer needs if an export strips its meshes and its mask texture: the corners of convex
	/// hulls, one entry for each of the meshes, and the texture's image. Returns false if there is nothing to store.
	/// The stored data is only used in place of stripped resources.
	bool embed_stripped_data();
	void set_convex_hulls(const godot::Array &p_hulls);
	godot::Array get_convex_hulls() const;
	void set_mask_texture_image(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> get_mask_texture_image() const;

	/// Adds one problem for each feature that cannot work because an export has stripped its resource.
	void add_stripped_problems(godot::PackedStringArray &r_problems) const;

	/// Stores an ID that a node gave to the layer.
	void take_id(std::int64_t p_id);

	/// True if the resource is this layer, or if a scene that stores this layer also stores the resource, a layer or a
	/// value, inside of it.
	bool stores(const godot::Resource *p_resource) const;

	/// Changes this layer's references to other layers.
	void change_references(const ReferenceChange &change);

	/// All current settings of the layer. `index` is the layer's index in its node's list. The index becomes the ID of
	/// the layer's points, unless `layer_id` is set. The settings contain neither neighbors nor shapes, because the
	/// node adds those. A table, a field or a mask is the same object as in the previous snapshot until its content
	/// changes.
	LayerSnapshot snapshot(std::uint64_t seed, std::size_t index);

	/// The part of the snapshot that refers to other layers.
	LayerLinks links();
	std::int64_t own_id() const { return identity_.layer_id; } ///< The property `layer_id`; -1 to use the index.

	/// Refuses settings that the core would refuse, and tiles of more than max_tile_points points.
	Status check();

	/// True if the layer can only have instances in water.
	bool needs_water() const { return settings_.rules.min_water_depth > -unlimited_height; }

	/// Adds the resources that the main thread reads along with the layer.
	void add_used(SceneUse::List &r_used) const;

	/// Likely mistakes, for the editor's warnings.
	godot::PackedStringArray problems();

	static constexpr double max_tile_points = 4e6;
	static constexpr std::int32_t max_texture = 255;

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value);
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// The part of the layer that contains values of this type. Properties are stored directly in the form in which the
	/// core uses them.
	template <class Values, class Self>
	static auto &part(Self &self);

	LayerSettings settings(std::uint64_t seed, std::size_t index) const;
	InstanceData instance_data() const;
	LayerGameplay gameplay() const;
	std::vector<std::string> field_names() const;
	template <const auto &property>
	void remake();
	void refresh();
	godot::Ref<godot::Resource> resource(std::string_view property) const;
	void read_models();
	bool needs_stored_hulls() const;
	void use_stored_hulls(LayerCollision &r_collision) const;
	void watch_meshes(bool p_watch);
	void replace_meshes(const LayerMeshes &p_meshes);
	void convert_former_lods(bool p_now);
	void watch_mask(bool p_watch);
	void watch_values(bool p_watch);
	void set_value(const char *p_property, const godot::Ref<ScatterValueSource> &p_value,
			godot::Ref<ScatterValueSource> &r_own);
	bool set_former_value(const godot::StringName &p_name, const godot::Variant &p_value);
	void changed();
	std::uint64_t hidden_properties() const;

	void add_number_problems(godot::PackedStringArray &r_problems) const;
	void add_curve_problems(godot::PackedStringArray &r_problems) const;
	void add_mask_problems(godot::PackedStringArray &r_problems) const;
	void add_neighbor_problems(godot::PackedStringArray &r_problems) const;
	void add_lod_problems(godot::PackedStringArray &r_problems) const;
	void add_mesh_problems(godot::PackedStringArray &r_problems) const;
	void add_source_problems(godot::PackedStringArray &r_problems) const;
	void add_gameplay_problems(godot::PackedStringArray &r_problems) const;

	template <const auto &property>
	static void bind_number();
	template <const auto &property>
	static void bind_integer();
	template <const auto &property>
	static void bind_switch();
	template <const auto &property>
	static void bind_resource();
	static void bind_basics();
	static void bind_advanced();
	static void bind_rules();
	static void bind_masks();
	static void bind_neighbors();
	static void bind_placement();
	static void bind_meshes();
	static void bind_fit();
	static void bind_drawing();
	static void bind_sources();
	static void bind_lod();
	static void bind_gameplay();
	static void bind_export();

	// Contain the values of single properties. `refresh` adds the tables that are created from resources, and the
	// snapshot adds the data that is created from lists.
	LayerSettings settings_;
	StreamLayer range_;
	LayerDrawing drawing_;
	LodSettings lod_;
	LayerGameplay gameplay_;
	LayerLinks links_;
	MaskFrame mask_frame_;
	LayerIdentity identity_;

	std::map<std::string_view, LayerResource> resources_; ///< By the names of their properties.
	LayerTables tables_;
	std::uint64_t hidden_ = 0; ///< The value of hidden_properties() when the inspector was last refreshed.

	godot::Ref<ScatterMask> mask_;
	godot::Rect2 mask_texture_rect_{0.0F, 0.0F, 1000.0F, 1000.0F}; ///< As set; mask_frame_ has the area too.
	godot::PackedInt32Array ground_textures_;
	godot::Dictionary spacing_property_; ///< With keys as returned by stored_reference; read-only.
	godot::Variant proximity_layer_ = godot::String();
	godot::Ref<ScatterValueSource> color_value_;
	godot::Ref<ScatterValueSource> variation_value_;

	LayerMeshes meshes_;
	godot::PackedFloat32Array mesh_weights_;
	FormerLods former_lods_;
	FormerVisibility former_visibility_;
	godot::Ref<godot::Material> material_override_;

	godot::Ref<godot::PhysicsMaterial> physics_material_;
	godot::Ref<godot::PackedScene> scene_;
	std::vector<BodyPart> convex_hulls_; ///< One for each of the meshes.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskChannel)
VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskEdge)
VARIANT_ENUM_CAST(thicket::ScatterLayer::CollisionShape)
VARIANT_ENUM_CAST(thicket::ScatterLayer::ModelKind)
