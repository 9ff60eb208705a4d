#pragma once

#include "core/placement/mesh_choice.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/layer/expression_text.hpp"
#include "nodes/layer/former_drawing.hpp"
#include "nodes/layer/layer_meshes.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/layer/layer_tables.hpp"
#include "nodes/layer/reference_change.hpp"
#include "nodes/layer/scatter_mask.hpp"
#include "nodes/layer/scatter_rows.hpp"
#include "nodes/layer/scatter_rule.hpp"
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

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace thicket {

/// The properties of a ScatterLayer that do not belong to any part of its snapshot.
struct LayerIdentity {
	std::int64_t layer_id = -1; ///< -1 until a node assigns an ID.
};

class ScatterLayer;

/// A property that is a resource (compare NumberProperty). `make` converts the resource to a table
/// when a snapshot first needs it. The table is stored in `member`, in one of the parts that
/// ScatterLayer::part returns. The resource has the class of `make`'s argument.
template <class Values, class Value, class T>
struct ResourceProperty {
	using Resource = T;

	const char *name;
	Value Values::*member;
	Value (*make)(const godot::Ref<T> &);
};

template <class Values, class Value, class T>
ResourceProperty(const char *, Value Values::*, Value (*)(const godot::Ref<T> &)) -> ResourceProperty<Values, Value, T>;

template <const auto &property>
using ResourceOf = typename std::remove_cvref_t<decltype(property)>::Resource;

/// The value of a ResourceProperty.
struct LayerResource {
	godot::Ref<godot::Resource> value;
	/// Rebuilds the table from the resource. Null if the table is up to date.
	void (ScatterLayer::*remake)() = nullptr;
};

/// A boolean property, stored in one of the parts that ScatterLayer::part returns.
template <class Values>
struct SwitchProperty {
	const char *name;
	const char *getter; ///< The name of the getter in the engine's style, such as "is_using_colors".
	bool Values::*member;
};

template <class Values>
SwitchProperty(const char *, const char *, bool Values::*) -> SwitchProperty<Values>;

/// A species or family of plants or rocks: its placement rules, meshes, and drawing and gameplay
/// settings. Contains settings only.
///
/// A setter rejects a value that is not finite or is out of range. It prints one error that names
/// the property and the value, and keeps the old value. A minimum above its maximum is reported
/// only when the layer is used, so that both can be set in any order. Existing instances stay until
/// it is fixed.
///
/// Every setter emits `changed`, and the layer also emits it when one of its resources does.
/// Painting on the mask emits `area_changed` instead, with a world rectangle that contains all
/// changes to the mask.
class ScatterLayer : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterLayer, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterLayer";

	/// The values of ImageChannel, for scripts.
	enum MaskChannel : std::int64_t {
		MASK_CHANNEL_RED,
		MASK_CHANNEL_GREEN,
		MASK_CHANNEL_BLUE,
		MASK_CHANNEL_ALPHA,
		MASK_CHANNEL_LUMINANCE,
		MASK_CHANNEL_NONE, ///< The texture is not a mask and only provides inputs of expressions.
	};

	/// The values of the core's MaskEdge, for scripts.
	enum MaskEdge : std::int64_t {
		MASK_EDGE_NOTHING,
		MASK_EDGE_EVERYTHING,
		MASK_EDGE_CLAMP,
		MASK_EDGE_REPEAT,
	};

	/// The values of BodyShape, for scripts: the collision shape of an instance near a viewer.
	/// Capsules, cylinders and boxes have the size of instance_radius and instance_height.
	enum CollisionShape : std::int64_t {
		COLLISION_NONE,
		COLLISION_CAPSULE,
		COLLISION_CYLINDER,
		COLLISION_BOX,
		COLLISION_CONVEX, ///< The convex hull of the instance's mesh.
		COLLISION_MODEL,  ///< The shapes of the instance's model.
	};

	/// The kind of plant or rock that a layer's meshes are, for fit_to_meshes.
	enum ModelKind : std::int64_t {
		KIND_AUTOMATIC, ///< Determined by name or size; see get_model_kind.
		KIND_TREE,
		KIND_SHRUB,
		KIND_GRASS,
		KIND_ROCK,
	};

	// These templates set and get properties; scatter_layer_properties.hpp defines them.
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

	/// Sets a mask with a painted density; null for none. Layers may share a mask.
	void set_mask(const godot::Ref<ScatterMask> &p_mask);
	godot::Ref<ScatterMask> get_mask() const;
	void mask_area_changed(const godot::Rect2 &p_rect);

	/// Sets the area that the mask texture covers, in world meters. The rectangle's y is the
	/// world's z. Width and height are at least 0.001.
	void set_mask_texture_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_mask_texture_rect() const;
	void set_mask_texture_channel(MaskChannel p_channel);
	MaskChannel get_mask_texture_channel() const;
	void set_mask_texture_edge(MaskEdge p_edge);
	MaskEdge get_mask_texture_edge() const;

	/// Sets the indices of the ground textures on which the layer grows, each 0 to max_texture. An
	/// empty array permits all textures.
	void set_ground_textures(const godot::PackedInt32Array &p_textures);
	godot::PackedInt32Array get_ground_textures() const;

	/// Sets the text of a density expression; an empty text disables it. An invalid text is reported,
	/// and the old one is kept.
	void set_density_expression(const godot::String &p_text);
	godot::String get_density_expression() const;

	/// Sets rules that scripts implement, at most max_density_rules. Null entries have no effect. The
	/// returned Array is read-only.
	void set_density_rules(const godot::TypedArray<ScatterRule> &p_rules);
	godot::TypedArray<ScatterRule> get_density_rules() const;
	void density_rule_changed();

	/// Makes the next snapshot rebuild all density rules, which may have changed without a signal.
	void distrust_density_rules() { density_rules_outdated_ = !density_rules_.empty(); }

	/// Sets the distances in meters to keep from the instances of other layers. A key is a
	/// ScatterLayer, its name or its index; a value is 0.001 to max_neighbor_distance. At most
	/// max_neighbors entries are allowed. A layer that has a name is stored by name. The returned
	/// Dictionary is read-only.
	void set_spacing(const godot::Dictionary &p_spacing);
	godot::Dictionary get_spacing() const;

	/// Sets the layer whose instances determine the density of this one: a ScatterLayer, its name
	/// or its index. Null or "" means no layer.
	void set_proximity_layer(const godot::Variant &p_layer);
	godot::Variant get_proximity_layer() const;

	/// Sets the layers on whose models this layer grows instead of on the ground. An entry is a
	/// ScatterLayer, its name or its index. At most max_hosts entries are allowed. A layer that has
	/// a name is stored by name. The returned Array is read-only.
	void set_surface_layers(const godot::Array &p_layers);
	godot::Array get_surface_layers() const;
	bool has_surface_layers() const { return !links_.surface_layers.empty(); }

	/// Sets the meshes, scenes and models to draw at the points. Null entries draw nothing.
	/// LayerMeshes::set_entries describes which entries are invalid.
	void set_meshes(const godot::Array &p_meshes);
	godot::Array get_meshes() const;

	/// Returns a name for an entry of `meshes`: that of its resource, part or file, or its index.
	godot::String mesh_name(std::size_t mesh) const;

	/// `meshes_differ` returns true if a script has changed the list that `get_meshes` returned,
	/// which scripts share. `take_mesh_changes` applies the change like `set_meshes`, or restores
	/// the previous list if the change is invalid.
	bool meshes_differ() const { return meshes_.differs(); }
	void take_mesh_changes();
	void meshes_changed();

	/// Returns the number of times that meshes and models in `meshes` have emitted `changed`.
	std::uint64_t mesh_version() const { return mesh_version_; }

	/// Reads the next part of the scenes and models in `meshes` (see LayerMeshes). Snapshots only
	/// contain the parts that have already been read.
	bool read_step();

	/// Rereads those scenes in `meshes` whose files are among these paths. Call it when the files
	/// have changed.
	void reload_scenes(const godot::PackedStringArray &p_paths);

	/// Sets the properties that depend on the size and kind of `meshes` (see get_fitted_properties
	/// and fit_of). Sets collision_shape only if a model has shapes. Returns false without setting
	/// anything if there are no meshes.
	bool fit_to_meshes(ModelKind p_kind = KIND_AUTOMATIC);

	/// Returns the kind that the name or size of the widest mesh suggests; KIND_AUTOMATIC if there
	/// are no meshes.
	ModelKind get_model_kind();

	/// Returns the names of the properties that fit_to_meshes sets.
	godot::PackedStringArray get_fitted_properties() const;

	/// Sets the relative frequency of each mesh, 0 to 1e6. Missing entries are treated as 1.
	void set_mesh_weights(const godot::PackedFloat32Array &p_weights);
	godot::PackedFloat32Array get_mesh_weights() const;

	/// Sets the text of a density expression for each mesh, by which its weight is multiplied. Empty
	/// and missing texts have no effect. A list with an invalid text is reported, and the old one is
	/// kept.
	void set_mesh_density_expressions(const godot::PackedStringArray &p_texts);
	godot::PackedStringArray get_mesh_density_expressions() const;

	void set_material_override(const godot::Ref<godot::Material> &p_material);
	godot::Ref<godot::Material> get_material_override() const;

	/// Returns the materials that instances are drawn with, without duplicates (see materials_of).
	godot::TypedArray<godot::Material> get_materials();

	/// Returns the values of the properties that GeometryInstance3D also has, keyed by their names
	/// in GeometryInstance3D.
	godot::Dictionary get_geometry_properties() const;

	/// These setters set the sources of an instance's color on the gradient, of its variation, and
	/// of its scale. Null selects random numbers. Layers may share a source.
	void set_color_value(const godot::Ref<ScatterValueSource> &p_value);
	godot::Ref<ScatterValueSource> get_color_value() const { return color_value_; }
	void set_variation_value(const godot::Ref<ScatterValueSource> &p_value);
	godot::Ref<ScatterValueSource> get_variation_value() const { return variation_value_; }
	void set_scale_value(const godot::Ref<ScatterValueSource> &p_value);
	godot::Ref<ScatterValueSource> get_scale_value() const { return scale_value_; }

	/// Returns all LODs of an entry of `meshes`, finest first, with all defaults resolved. Returns
	/// an empty array for an entry that draws nothing. Prints an error for an invalid index.
	godot::TypedArray<ScatterLod> get_mesh_lods(int64_t p_index);

	void set_collision_shape(CollisionShape p_shape);
	CollisionShape get_collision_shape() const;

	/// Sets the friction and bounce of the bodies. Null selects the engine's defaults.
	void set_physics_material(const godot::Ref<godot::PhysicsMaterial> &p_material);
	godot::Ref<godot::PhysicsMaterial> get_physics_material() const;

	/// Sets the scene that replaces meshes near viewers; null for none.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const;

	/// Sets the rows that contain the layer's instances. If null, the instances are spread evenly.
	void set_rows(const godot::Ref<ScatterRows> &p_rows);
	godot::Ref<ScatterRows> get_rows() const { return rows_; }

	/// Returns true if a property affects placement, false if it only affects drawing or gameplay
	/// (see PropertyUse).
	bool affects_placement(const godot::StringName &p_property) const;

	/// Returns the columns of ScatterTile.get_rows for this layer: the type of each column, keyed
	/// by its name.
	godot::Dictionary get_row_columns() const;
	/// Returns the tile size and the view distance.
	const StreamLayer &range() const { return range_; }
	bool is_on_surfaces() const { return settings_.set.on_surface; }

	/// Returns the result of free_layer_name, for scripts.
	godot::String find_free_name(const godot::String &p_name, const godot::PackedStringArray &p_taken) const;

	/// Returns the average number of points of the layer's set per square meter, before any rule
	/// applies.
	double get_point_density() const;

	/// Stores the data that the layer needs if an export strips its meshes and mask texture. The
	/// data is the corners of each mesh's convex hull and the texture's image. The data is only
	/// used in place of stripped resources. Returns false if there is nothing to store.
	bool embed_stripped_data();
	void set_convex_hulls(const godot::Array &p_hulls);
	godot::Array get_convex_hulls() const;
	void set_mask_texture_image(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> get_mask_texture_image() const;

	/// Adds one problem for each feature that does not work because an export has stripped a
	/// resource.
	void add_stripped_problems(godot::PackedStringArray &r_problems) const;

	/// Stores the ID that a node assigns to the layer.
	void take_id(std::int64_t p_id);

	/// Returns true if a resource is this layer, or if saving this layer also saves the resource as
	/// a part of it. The resource may be a layer or a ScatterValueSource.
	bool stores(const godot::Resource *p_resource) const;

	/// Applies a change to this layer's references to other layers.
	void change_references(const ReferenceChange &change);

	/// Returns all current settings. `index` is the layer's index in its node's list, and becomes
	/// the ID of the layer's points unless `layer_id` is set. The settings lack neighbors and
	/// shapes, which the node adds. A table, field or mask is the same object as in the previous
	/// snapshot until its content changes.
	LayerSnapshot snapshot(std::uint64_t seed, std::size_t index);

	/// Returns the part of the snapshot that refers to other layers.
	LayerLinks links();

	/// Returns the world inputs of all expressions of the layer, in any order and possibly repeated.
	std::vector<WorldInput> world_inputs() const;
	/// Returns the property `layer_id`; -1 if it is not set.
	std::int64_t own_id() const { return identity_.layer_id; }

	/// Returns an error for settings that the core rejects, and for tiles of more than
	/// max_tile_points points.
	Status check();

	/// Returns true if the layer has instances only in water.
	bool needs_water() const { return settings_.rules.min_water_depth > -unlimited_height; }

	/// Adds the resources that the main thread reads along with the layer to `r_used`.
	void add_used(SceneUse::List &r_used) const;

	/// Returns likely mistakes, for the editor's configuration warnings.
	godot::PackedStringArray problems();

	static constexpr double max_tile_points = 4e6;
	static constexpr std::int32_t max_texture = 255;

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value);
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// Returns the member that has the type `Values`. Such a member stores properties directly in
	/// the form that the core uses.
	template <class Values, class Self>
	static auto &part(Self &self);

	LayerSettings settings(std::uint64_t seed, std::size_t index) const;
	PointSet point_set() const;
	std::vector<std::optional<Rules>> mesh_rules() const;
	std::uint32_t used_mask_channels() const;
	void rename_in_expressions(const ReferenceChange &change);
	InstanceData instance_data() const;
	LayerGameplay gameplay() const;
	std::vector<std::string> field_names() const;
	template <const auto &property>
	void remake();
	void refresh();
	void watch_density_rules(bool p_watch);
	void remake_density_rules();
	godot::Ref<godot::Resource> resource(std::string_view property) const;
	void read_models();
	bool needs_stored_hulls() const;
	void use_stored_hulls(LayerCollision &r_collision) const;
	void watch_meshes(bool p_watch);
	void replace_meshes(const LayerMeshes &p_meshes);
	void convert_former_lods(bool p_include_incomplete);
	void watch_mask(bool p_watch);
	void watch_values(bool p_watch);
	void set_value(const char *p_property, const godot::Ref<ScatterValueSource> &p_value,
			godot::Ref<ScatterValueSource> &r_current);
	bool set_former_value(const godot::StringName &p_name, const godot::Variant &p_value);
	void mark_changed();
	std::uint64_t hidden_properties() const;

	void add_number_problems(godot::PackedStringArray &r_problems) const;
	void add_curve_problems(godot::PackedStringArray &r_problems) const;
	void add_mask_problems(godot::PackedStringArray &r_problems) const;
	void add_density_rule_problems(godot::PackedStringArray &r_problems) const;
	void add_neighbor_problems(godot::PackedStringArray &r_problems) const;
	void add_host_problems(godot::PackedStringArray &r_problems) const;
	void add_row_problems(godot::PackedStringArray &r_problems) const;
	void change_surface_layers(const ReferenceChange &change);
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
	static void bind_hosts();
	static void bind_rows();
	static void bind_masks();
	static void bind_neighbors();
	static void bind_placement();
	static void bind_meshes();
	static void bind_fit();
	static void bind_drawing();
	static void bind_sources();
	static void bind_scale_value();
	static void bind_lod();
	static void bind_gameplay();
	static void bind_export();

	// The values of single properties. `refresh` adds tables that are created from resources.
	// `snapshot` adds data that is created from lists.
	LayerSettings settings_;
	StreamLayer range_;
	LayerDrawing drawing_;
	LodSettings lod_;
	LayerGameplay gameplay_;
	LayerLinks links_;
	MaskFrame mask_frame_;
	LayerIdentity identity_;

	/// The values of all ResourceProperties, keyed by property name.
	std::map<std::string_view, LayerResource> resources_;
	LayerTables tables_;
	/// The result of hidden_properties() when the inspector was last updated.
	std::uint64_t hidden_properties_ = 0;

	godot::Ref<ScatterMask> mask_;
	godot::Ref<ScatterRows> rows_;
	/// The rectangle as set; mask_frame_ has the same area in double precision.
	godot::Rect2 mask_texture_rect_{0.0F, 0.0F, 1000.0F, 1000.0F};
	godot::PackedInt32Array ground_textures_;
	std::vector<godot::Ref<ScatterRule>> density_rules_;
	std::vector<std::string> density_rule_names_; ///< The names of the rules in `settings_`.
	bool density_rules_outdated_ = false;         ///< True if `settings_` has former rules.
	godot::Dictionary spacing_property_;          ///< The keys are results of stored_reference. Read-only.
	godot::Variant proximity_layer_ = godot::String();
	godot::Array surface_layers_; ///< Results of stored_reference.
	godot::Ref<ScatterValueSource> color_value_;
	godot::Ref<ScatterValueSource> variation_value_;
	godot::Ref<ScatterValueSource> scale_value_;

	LayerMeshes meshes_;
	std::atomic<std::uint64_t> mesh_version_ = 0;
	godot::PackedFloat32Array mesh_weights_;
	std::vector<SharedExpression> mesh_expressions_;
	FormerLods former_lods_;
	FormerVisibility former_visibility_;
	godot::Ref<godot::Material> material_override_;

	godot::Ref<godot::PhysicsMaterial> physics_material_;
	godot::Ref<godot::PackedScene> scene_;
	std::vector<BodyPart> convex_hulls_; ///< The convex hull of each entry of `meshes_`.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskChannel)
VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskEdge)
VARIANT_ENUM_CAST(thicket::ScatterLayer::CollisionShape)
VARIANT_ENUM_CAST(thicket::ScatterLayer::ModelKind)
