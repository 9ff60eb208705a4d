#pragma once

#include "core/placement/mesh_choice.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/layer/layer_meshes.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/layer/layer_tables.hpp"
#include "nodes/layer/scatter_mask.hpp"

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

/// What is only a ScatterLayer's own, beside the parts of its snapshot.
struct LayerIdentity {
	std::int64_t layer_id = -1; ///< -1 until a node has given the layer one.
};

class ScatterLayer;

/// A resource among a layer's properties, as NumberProperty is a number. `make` makes a table of it, as late as a snapshot needs
/// it, and `member` keeps that in one of the parts that ScatterLayer::part finds. The inspector offers the class that `make` takes.
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
	void (ScatterLayer::*remake)() = nullptr; ///< Makes its table anew; null while the table is up to date.
};

/// A switch among a layer's properties, in one of the parts that ScatterLayer::part finds.
template <class Values>
struct SwitchProperty {
	const char *name;
	const char *getter; ///< "is_using_colors" and the like, as the engine names them.
	bool Values::*member;
};

/// One species or family, placed by one rule set: what stands where, and how it is drawn. Settings only.
///
/// A setter refuses what is not finite or out of range: one error that names the property and the value, and the value
/// stays. A minimum above its maximum is found when the layer is used, so that both may be set in any order; the error
/// comes then, and what stands stays.
///
/// `changed` is emitted by every setter, and whenever one of the layer's own resources emits it. Only what is painted on the
/// mask comes as `area_changed`, with the rectangle of the world outside which the mask is as it was.
class ScatterLayer : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterLayer, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

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
	enum MaskEdge : std::int64_t {
		MASK_EDGE_NOTHING,
		MASK_EDGE_EVERYTHING,
		MASK_EDGE_CLAMP,
		MASK_EDGE_REPEAT,
	};

	/// BodyShape, for scripts: what bodies meet of an instance that is near. Of instance_radius and instance_height, but for the last.
	enum CollisionShape : std::int64_t {
		COLLISION_NONE,
		COLLISION_CAPSULE,
		COLLISION_CYLINDER,
		COLLISION_BOX,
		COLLISION_CONVEX, ///< The convex hull of the instance's mesh.
		COLLISION_MODEL,  ///< The shapes of the instance's model.
	};

	/// SourceKind, for scripts: what a number of an instance's look follows.
	enum ValueSource : std::int64_t {
		SOURCE_RANDOM,
		SOURCE_HEIGHT,
		SOURCE_SLOPE,
		SOURCE_NOISE,
		SOURCE_RANK,
		SOURCE_DISTANCE,
	};

	// The properties that scatter_layer_properties.hpp makes of one line each.
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

	/// A painted density; null for none. Layers may share it.
	void set_mask(const godot::Ref<ScatterMask> &p_mask);
	godot::Ref<ScatterMask> get_mask() const;
	void mask_area_changed(const godot::Rect2 &p_rect);

	/// World meters that the mask texture covers: x, and z as y. Its sides are at least 0.001.
	void set_mask_texture_rect(const godot::Rect2 &p_rect);
	godot::Rect2 get_mask_texture_rect() const;
	void set_mask_texture_channel(MaskChannel p_channel);
	MaskChannel get_mask_texture_channel() const;
	void set_mask_texture_edge(MaskEdge p_edge);
	MaskEdge get_mask_texture_edge() const;

	/// The terrain's textures that the layer stands on, 0 to max_texture each; none for any ground.
	void set_ground_textures(const godot::PackedInt32Array &p_textures);
	godot::PackedInt32Array get_ground_textures() const;

	/// Other layers, each as a ScatterLayer, its name or its index, and the meters that are kept free around their
	/// instances: 0.001 to max_neighbor_distance; at most max_neighbors layers. A layer that has a name is kept by it. What
	/// is read back is read-only.
	void set_spacing(const godot::Dictionary &p_spacing);
	godot::Dictionary get_spacing() const;

	/// The layer whose instances decide about this one's density: a ScatterLayer, its name or its index; null or "" for none.
	void set_proximity_layer(const godot::Variant &p_layer);
	godot::Variant get_proximity_layer() const;

	/// What may stand at a point: meshes, scenes and models. Null entries draw nothing. See LayerMeshes for what is refused.
	void set_meshes(const godot::Array &p_meshes);
	godot::Array get_meshes() const;

	/// Scripts share the list that `get_meshes` returns: whether they have changed it in place, and the call that takes this over as
	/// `set_meshes` would. A list that is refused is replaced by the one of before.
	bool meshes_differ() const { return meshes_.differs(); }
	void take_mesh_changes();

	/// Reads the next part of the scenes and models in `meshes`; see LayerMeshes. A snapshot, and all that asks for meshes, has what is read so far.
	bool read_step();

	/// Reads anew what `meshes` has of these scenes, by their paths: their files have changed.
	void reload_scenes(const godot::PackedStringArray &p_paths);

	/// Sets what follows from the size of what stands in `meshes`: radius, instance_radius, instance_height; and collision_shape, if a model has
	/// shapes. False, and nothing, without meshes.
	bool fit_to_meshes();

	/// How often each of the meshes is used, in proportion, 0 to 1e6; missing ones count as 1.
	void set_mesh_weights(const godot::PackedFloat32Array &p_weights);
	godot::PackedFloat32Array get_mesh_weights() const;

	void set_material_override(const godot::Ref<godot::Material> &p_material);
	godot::Ref<godot::Material> get_material_override() const;

	/// The materials that instances are drawn with, each once: see materials_of.
	godot::TypedArray<godot::Material> get_materials();

	/// By the names of properties, those of GeometryInstance3D that do the same.
	godot::Dictionary get_geometry_properties() const;

	/// What an instance's place on the gradient follows, and what its variation; and for a distance, the layer that is meant, as
	/// for set_proximity_layer.
	void set_color_source(ValueSource p_source);
	ValueSource get_color_source() const;
	void set_color_source_layer(const godot::Variant &p_layer);
	godot::Variant get_color_source_layer() const;
	void set_variation_source(ValueSource p_source);
	ValueSource get_variation_source() const;
	void set_variation_source_layer(const godot::Variant &p_layer);
	godot::Variant get_variation_source_layer() const;

	/// What replaces the meshes from each of the LOD distances on: a row of entries for the meshes, then the row of
	/// the next distance. Null for the finer mesh; at most max_lods rows of max_meshes.
	void set_lod_meshes(const godot::TypedArray<godot::Mesh> &p_meshes);
	godot::TypedArray<godot::Mesh> get_lod_meshes() const;

	/// The LODs that an entry of `meshes` is drawn by, the finest first, with nothing left open: those of its model, and those of `lod_meshes`.
	/// None for an entry that draws nothing; an index that is not there prints an error.
	godot::TypedArray<ScatterLod> get_mesh_lods(int64_t p_index);

	/// Meters from a viewer to a tile's box, ascending, 0 to 1e6 each; at most max_lods.
	void set_lod_distances(const godot::PackedFloat32Array &p_distances);
	godot::PackedFloat32Array get_lod_distances() const;

	void set_collision_shape(CollisionShape p_shape);
	CollisionShape get_collision_shape() const;

	/// Friction and bounce of the bodies; null for the engine's own.
	void set_physics_material(const godot::Ref<godot::PhysicsMaterial> &p_material);
	godot::Ref<godot::PhysicsMaterial> get_physics_material() const;

	/// What replaces the mesh near viewers; null for the mesh everywhere.
	void set_scene(const godot::Ref<godot::PackedScene> &p_scene);
	godot::Ref<godot::PackedScene> get_scene() const;

	/// False for a property that only decides how instances are drawn, or how a game meets them: see PropertyUse.
	bool affects_placement(const godot::StringName &p_property) const;

	/// The columns of ScatterTile.get_rows for the layer, by name: the types of their numbers.
	godot::Dictionary get_row_columns() const;

	/// free_layer_name, for scripts.
	godot::String find_free_name(const godot::String &p_name, const godot::PackedStringArray &p_taken) const;

	/// Points of the layer's set in a square meter, on average, before any rule.
	double get_point_density() const;

	/// Stores what the layer needs of its meshes and its mask texture where an export strips them: corners of convex hulls, one entry for each of
	/// the meshes, and the texture's image. False if there is nothing to store. The stored data is used only for what was stripped.
	bool embed_stripped_data();
	void set_convex_hulls(const godot::Array &p_hulls);
	godot::Array get_convex_hulls() const;
	void set_mask_texture_image(const godot::Ref<godot::Image> &p_image);
	godot::Ref<godot::Image> get_mask_texture_image() const;

	/// What cannot work because it was stripped from the export.
	void add_stripped_problems(godot::PackedStringArray &r_problems) const;

	/// Has the layer keep an id that a node gave it.
	void take_id(std::int64_t p_id);

	/// A layer that was named `p_from` is now named `p_to`: what this one says of it follows. An empty `p_from` stands for a
	/// layer that had no name and was held itself.
	void rename_references(const godot::String &p_from, const godot::String &p_to);

	/// All that the layer says now. `index` is the layer's index among its node's layers: it is the id of the layer's points, unless
	/// `layer_id` says otherwise. The settings have no neighbors and no shapes, which are the node's. A table, a field or a mask in
	/// the snapshot is the same object as in the snapshot before until what it says has changed.
	LayerSnapshot snapshot(std::uint64_t seed, std::size_t index);

	/// The part of the snapshot that is about other layers.
	LayerLinks links();
	std::int64_t own_id() const { return identity_.layer_id; } ///< The property `layer_id`; -1 for the index.

	/// Refuses what the core would refuse, and tiles of more than max_tile_points points.
	Status check();

	/// True if the layer stands nowhere unless there is water.
	bool needs_water() const { return settings_.rules.min_water_depth > -unlimited_height; }

	/// Adds what the main thread reads along with the layer.
	void add_used(SceneUse::List &r_used) const;

	/// What is likely not meant, for the editor's warnings.
	godot::PackedStringArray problems();

	static constexpr double max_tile_points = 4e6;
	static constexpr std::int32_t max_texture = 255;

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value) {
		return set_renamed(this, p_name, p_value);
	}
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	/// The part of the layer that has such values: its properties are kept in the form in which they are used.
	template <class Values, class Self>
	static auto &part(Self &self);

	LayerSettings settings(std::uint64_t seed, std::size_t index) const;
	InstanceData instance_data() const;
	LayerGameplay gameplay() const;
	std::vector<std::string> field_names() const;
	LodSettings lod() const;
	template <const auto &property>
	void remake();
	void refresh();
	godot::Ref<godot::Resource> resource(std::string_view property) const;
	void read_models();
	bool needs_stored_hulls() const;
	void use_stored_hulls(LayerCollision &r_collision) const;
	void watch_meshes(bool p_watch);
	void watch_mask(bool p_watch);
	bool stores(const ScatterLayer *p_layer) const;
	godot::Variant accept_reference(const char *p_property, const godot::Variant &p_reference) const;
	void set_reference(
			const char *p_property, const godot::Variant &p_layer, godot::Variant &r_stored, LayerReference &r_linked);
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
	static void bind_drawing();
	static void bind_sources();
	static void bind_lod();
	static void bind_gameplay();
	static void bind_export();

	// Each has what single properties stand for; `refresh` adds the tables made of resources, the snapshot what is made of lists.
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
	std::uint64_t hidden_ = 0; ///< hidden_properties(), as the inspector was told last.

	godot::Ref<ScatterMask> mask_;
	godot::Rect2 mask_texture_rect_{0.0F, 0.0F, 1000.0F, 1000.0F}; ///< As it was set; mask_frame_ has it too.
	godot::PackedInt32Array ground_textures_;
	godot::Dictionary spacing_property_; ///< As stored_reference has the keys; read-only.
	godot::Variant proximity_layer_ = godot::String();
	godot::Variant color_source_layer_ = godot::String();
	godot::Variant variation_source_layer_ = godot::String();

	LayerMeshes meshes_;
	godot::PackedFloat32Array mesh_weights_;
	godot::TypedArray<godot::Mesh> lod_meshes_;
	godot::PackedFloat32Array lod_distances_;
	godot::Ref<godot::Material> material_override_;

	godot::Ref<godot::PhysicsMaterial> physics_material_;
	godot::Ref<godot::PackedScene> scene_;
	std::vector<BodyPart> convex_hulls_; ///< Of each of the meshes.
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskChannel)
VARIANT_ENUM_CAST(thicket::ScatterLayer::MaskEdge)
VARIANT_ENUM_CAST(thicket::ScatterLayer::CollisionShape)
VARIANT_ENUM_CAST(thicket::ScatterLayer::ValueSource)
