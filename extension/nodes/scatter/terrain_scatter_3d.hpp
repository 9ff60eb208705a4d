#pragma once

#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/drawing/fade_viewers.hpp"
#include "nodes/drawing/instance_load.hpp"
#include "nodes/drawing/wind_time.hpp"
#include "nodes/explain/layer_explainer.hpp"
#include "nodes/gameplay/navigation_parse.hpp"
#include "nodes/gameplay/scatter_gameplay.hpp"
#include "nodes/ground/scatter_ground.hpp"
#include "nodes/layer/layer_watch.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/region/region_register.hpp"
#include "nodes/region/scatter_region_3d.hpp"
#include "nodes/scatter/layer_list.hpp"
#include "nodes/scatter/layer_previews.hpp"
#include "nodes/scatter/node_layers.hpp"
#include "nodes/scatter/scatter_stream.hpp"
#include "nodes/scatter/scatter_tile.hpp"
#include "nodes/scatter/scatter_viewers.hpp"
#include "nodes/workers/build_at_once.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

namespace thicket {

/// Streams layers of instances onto a ground around viewers, in the editor and in games. Instances
/// are placed in world space, so the node's transform does not move them. Instances are never
/// saved.
///
/// The node itself only has properties and signals. Its ScatterStream generates and draws tiles,
/// and its ScatterGameplay answers queries and stores changes. Methods hold shared references to
/// both objects during calls that may run scripts, because a script may free the node.
class TerrainScatter3D : public godot::Node3D, public ThreadGuarded, public RegionHost {
	GDCLASS(TerrainScatter3D, godot::Node3D)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "TerrainScatter3D";

	TerrainScatter3D();
	~TerrainScatter3D() override;

	/// Sets the seed, any 64-bit number. Different seeds place instances differently.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const { return seed_; }

	/// Sets the layers. A null entry draws nothing but keeps its index. Scripts share the array, so
	/// they may modify it in place.
	void set_layers(const godot::TypedArray<ScatterLayer> &p_layers);
	godot::TypedArray<ScatterLayer> get_layers() const { return layers_; }

	/// Sets the map of biomes, whose layers grow only in the areas of their biomes; null for no
	/// biomes.
	void set_biomes(const godot::Ref<ScatterBiomeMap> &p_biomes);
	godot::Ref<ScatterBiomeMap> get_biomes() const { return biomes_; }

	/// Returns a copy of the list of all layers: the node's own and those of its biomes. Empty
	/// entries are null.
	godot::TypedArray<ScatterLayer> get_all_layers() const { return copied(all_layers()); }

	/// Sets whether layer rules treat ground below `water_level` as under water. Does not draw any
	/// water.
	void set_water_enabled(bool p_enabled);
	bool is_water_enabled() const { return water_enabled_; }

	/// Sets the water level in world meters, from -ScatterBiome::max_water_level to
	/// ScatterBiome::max_water_level.
	void set_water_level(double p_level);
	double get_water_level() const { return water_level_; }

	/// Sets the ground to place instances on. If null, nothing is drawn.
	void set_ground(const godot::Ref<ScatterGround> &p_ground);
	godot::Ref<ScatterGround> get_ground() const { return ground_; }

	/// Sets the Node3Ds to stream around. If empty, streams around the viewport's current camera,
	/// or in the editor around the editor's cameras.
	void set_viewers(const godot::TypedArray<godot::NodePath> &p_viewers);
	godot::TypedArray<godot::NodePath> get_viewers() const { return viewers_.paths; }

	/// Sets factors for the view distance of all layers, one per viewer, each from 0 to 1e6.
	/// Missing entries are 1. If any value is out of range, prints an error and keeps the old list.
	void set_viewer_distance_scales(const godot::PackedFloat32Array &p_scales);
	godot::PackedFloat32Array get_viewer_distance_scales() const { return viewers_.distance_scales; }

	/// Sets the world position of the engine's origin in meters: world = engine + world_offset.
	/// Each coordinate is within +-1e12. Changing it does not regenerate or upload anything. All
	/// positions in the node's API are in the engine's space.
	void set_world_offset(const godot::Vector3 &p_offset);
	godot::Vector3 get_world_offset() const;

	/// Sets whether the world is the node's local space, so that instances move with the node.
	/// `world_offset` is then ignored.
	void set_local_coords(bool p_local);
	bool is_local_coords() const { return local_coords_; }

	/// Sets the node's time budget on the main thread per frame, in microseconds, 1 to 1e6.
	void set_frame_budget_usec(int64_t p_budget);
	int64_t get_frame_budget_usec() const { return frame_budget_usec_; }

	/// Sets the fraction of the instances in each tile that is drawn, 0 to 1. The drawn instances
	/// are those that layers with a density multiplied by this fraction would have. Changing it
	/// does not regenerate or upload anything.
	void set_quality(double p_quality);
	double get_quality() const { return quality_; }

	/// Sets the maximum number of instances drawn in the editor, 0 to 1e9. If it is exceeded, all
	/// tiles are thinned equally.
	void set_preview_instances(int64_t p_count);
	int64_t get_preview_instances() const { return preview_instances_; }

	/// Sets the maximum number of visible multimeshes, 0 to 1e6. When it is reached, no more tiles
	/// are divided into cells, and divided tiles are drawn as a whole again, farthest first.
	/// Undivided tiles are displayed even beyond the limit.
	void set_max_multimeshes(int64_t p_count);
	int64_t get_max_multimeshes() const { return max_multimeshes_; }

	/// Sets a group of Node3Ds. Bodies and scenes are created around them as around viewers.
	void set_interaction_group(const godot::StringName &p_group) { interaction_group_ = p_group; }
	godot::StringName get_interaction_group() const { return interaction_group_; }

	/// Regenerates all tiles. Existing instances stay visible until their replacements are ready.
	void regenerate();

	/// Rereads the ground over several frames and regenerates the tiles where it has changed. If
	/// the ground cannot detect where it has changed, regenerates all tiles.
	void refresh_ground();

	/// Returns true if all required tiles are visible and bodies, scenes and changes are up to
	/// date.
	bool is_settled() const;
	godot::Dictionary get_stats() const;

	/// Returns statistics of the instances that are currently drawn. If `p_camera` is not null,
	/// counts only those that the camera may see.
	godot::Dictionary get_draw_stats(godot::Camera3D *p_camera) const;

	/// Returns a message for each problem that keeps the node from displaying its layers correctly.
	/// The editor shows them as configuration warnings. May run scripts.
	godot::PackedStringArray get_problems() const;
	godot::PackedStringArray _get_configuration_warnings() const override {
		return guarded_call("TerrainScatter3D._get_configuration_warnings", [this] { return get_problems(); });
	}

	/// Returns the visible tiles of a layer. For the type of `p_layer`, here and below, see
	/// find_layer.
	godot::TypedArray<godot::Vector2i> get_shown_tiles(const godot::Variant &p_layer) const;

	/// Returns the number of instances of a layer in its visible tiles.
	int64_t get_shown_count(const godot::Variant &p_layer) const;

	// These methods are for the add-on's editor tools; see LayerPreviews.

	void set_preview_hidden(const godot::TypedArray<ScatterLayer> &p_layers) { previews_.set_hidden(p_layers); }
	void set_preview_stand_in(const godot::Ref<ScatterLayer> &p_layer, const godot::Ref<ScatterLayer> &p_stand_in);

	/// Returns the content of a tile as drawn; empty if the tile is not visible.
	godot::Ref<ScatterTile> get_tile(const godot::Variant &p_layer, const godot::Vector2i &p_tile);

	/// Generates the instances in a half-open rectangle of the engine's x and z, immediately on the
	/// main thread. If the layer does not exist or the rectangle is invalid, prints an error and
	/// returns an empty tile.
	godot::Ref<ScatterTile> build_rect(const godot::Variant &p_layer, const godot::Rect2 &p_rect);

	/// Generates a tile of the layer even if it is not visible. For a visible tile, the result is
	/// bit-identical to the result of `get_tile`. Unless `p_rect` is Rect2(), clips the tile to
	/// this rectangle in the engine's space. Adjacent clipped tiles still share their edges.
	godot::Ref<ScatterTile> build_tile(
			const godot::Variant &p_layer, const godot::Vector2i &p_tile, const godot::Rect2 &p_rect);

	// The editor's tools use the following methods. Call them only on the main thread. Unless the
	// comments say otherwise, all positions are in the engine's space.

	/// Returns the up direction at a position.
	godot::Vector3 up_at(const godot::Vector3 &p_position);

	/// Returns the first position at which a line enters a surface of the ground, and the normal
	/// there. Returns an empty array if the line enters none.
	godot::PackedVector3Array hit_surface(const godot::Vector3 &p_from, const godot::Vector3 &p_to);

	/// Returns the planet's center and radius as four numbers, or an empty array without a planet.
	godot::PackedFloat64Array get_planet();

	/// Returns positions relative to the planet's center, in the space of
	/// ScatterMask.paint_on_planet. Returns an empty array without a planet.
	godot::PackedVector3Array to_planet(const godot::PackedVector3Array &p_positions);

	/// Returns the highest ground at positions on the flat map of the planet around `p_center` (see
	/// PlanetMap). Where there is no ground, the result is NAN. Returns an empty array without a
	/// planet.
	godot::PackedVector3Array planet_ground(
			const godot::Vector3 &p_center, const godot::PackedVector2Array &p_positions);

	/// These methods are like get_density_map and get_slope_map, but return values at positions on
	/// any side of the ground.
	godot::PackedFloat32Array densities_at(const godot::Variant &p_layer, const godot::PackedVector3Array &p_positions);
	godot::PackedFloat32Array slopes_at(const godot::PackedVector3Array &p_positions);

	/// Explains the x and z of a position for each of `p_layers` (see find_layers). If a layer does
	/// not exist or the position is not finite, prints an error and returns an empty array.
	godot::TypedArray<ScatterExplanation> explain_position(
			const godot::Vector3 &p_position, const godot::Variant &p_layers);

	/// These methods return values at the cell centers of a grid over a rectangle, row by row.
	/// Densities after the layer's rules are 0 to 1. Slopes of the ground are in degrees, NAN
	/// without ground. Ranks are the ranks, 0 to 1, of the nearest points of the layer's set.
	godot::PackedFloat32Array get_density_map(
			const godot::Variant &p_layer, const godot::Rect2 &p_rect, const godot::Vector2i &p_size);
	godot::PackedFloat32Array get_slope_map(const godot::Rect2 &p_rect, const godot::Vector2i &p_size);
	godot::PackedFloat32Array get_rank_map(
			const godot::Variant &p_layer, const godot::Rect2 &p_rect, const godot::Vector2i &p_size);

	// These methods belong to the gameplay API. ScatterGameplay implements them.

	void set_state(const godot::Ref<ScatterState> &p_state);
	godot::Ref<ScatterState> get_state() const { return gameplay_->get_state(); }
	godot::Ref<ScatterInstances> query_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay()->query_rect(p_rect, p_layers, p_predicate);
	}
	godot::Ref<ScatterInstances> query_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay()->query_sphere(p_center, p_radius, p_layers, p_predicate);
	}
	godot::Ref<ScatterInstance> query_ray(const godot::Vector3 &p_from, const godot::Vector3 &p_to,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay()->query_ray(p_from, p_to, p_layers, p_predicate);
	}
	godot::Ref<ScatterInstance> query_nearest(const godot::Vector3 &p_position, double p_max_distance,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay()->query_nearest(p_position, p_max_distance, p_layers, p_predicate);
	}
	godot::Ref<ScatterInstance> get_instance(int64_t p_id) { return gameplay()->get_instance(p_id); }
	bool has_instance(int64_t p_id) { return gameplay()->has_instance(p_id); }
	godot::Ref<ScatterSnapshot> make_snapshot() { return gameplay()->make_snapshot(); }

	// Any thread may call the following request methods.
	godot::Ref<ScatterRequest> request_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay_->request_rect(p_rect, p_layers, p_predicate);
	}
	godot::Ref<ScatterRequest> request_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay_->request_sphere(p_center, p_radius, p_layers, p_predicate);
	}
	bool remove_instance(int64_t p_id) { return gameplay()->remove_instance(p_id); }
	bool restore_instance(int64_t p_id) { return gameplay()->restore_instance(p_id); }
	godot::PackedInt64Array remove_in_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) {
		return gameplay()->remove_in_sphere(p_center, p_radius, p_layers, p_predicate);
	}
	int64_t add_instance(const godot::Variant &p_layer, const godot::Transform3D &p_transform, int64_t p_mesh) {
		return gameplay()->add_instance(p_layer, p_transform, p_mesh);
	}
	godot::PackedInt64Array add_instances(const godot::Variant &p_layer, const godot::PackedFloat32Array &p_transforms,
			const godot::PackedInt32Array &p_meshes) {
		return gameplay()->add_instances(p_layer, p_transforms, p_meshes);
	}
	godot::PackedInt64Array remove_instances(const godot::PackedInt64Array &p_ids) {
		return gameplay()->remove_instances(p_ids);
	}
	int64_t set_instance_transform(int64_t p_id, const godot::Transform3D &p_transform) {
		return gameplay()->set_instance_transform(p_id, p_transform);
	}
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data) {
		return gameplay()->set_instance_data(p_id, p_data);
	}
	godot::Variant get_instance_data(int64_t p_id) const { return gameplay_->get_instance_data(p_id); }

	/// Returns the ID of the instance that a PhysicsServer3D body belongs to, or 0. A removed body
	/// still maps to its last instance until it is reused; see CollisionRing::rest_frames.
	int64_t get_body_instance(const godot::RID &p_body) const;

	/// Returns the scene that replaces an instance, or null.
	godot::Node3D *get_scene(int64_t p_id) const;

	/// Transfers ownership of the scene that replaces an instance to the caller. The instance's
	/// mesh is then drawn again, unless the instance was removed.
	godot::Node3D *take_scene(int64_t p_id);

	void add_region(ScatterRegion3D *p_region) override;
	void remove_region(ScatterRegion3D *p_region) override;
	void region_changed(const ScatterRegion3D *p_region) override;
	godot::String layer_problem(const godot::Variant &p_reference) const override;
	const WorldFrame &world_frame() const override { return frame_; }
	Planet planet() const override { return ground_.is_valid() ? ground_->planet() : Planet(); }
	godot::Transform3D transform_of(const godot::Node3D &p_node) const override;

protected:
	static void _bind_methods();
	bool _set(const godot::StringName &p_name, const godot::Variant &p_value) {
		return set_renamed(this, p_name, p_value);
	}
	void _notification(int p_what);

private:
	void handle_notification(int p_what);
	/// Implements the services that ScatterGameplay needs from the node.
	class Host final : public GameplayHost {
	public:
		explicit Host(TerrainScatter3D &node) : node_(node) {}
		godot::Node3D *node() override { return &node_; }
		Status prepare() override { return node_.prepare(); }
		void move_world() override { node_.move_world(); }
		TileMaker make_worker_maker() override { return node_.worker_tile_maker(); }
		void set_overlay(const InstanceState *state) override { node_.display().set_state(state); }
		void redraw(std::uint32_t layer, const Rect &area) override;
		void redraw_all() override;
		void redraw_later(std::uint32_t layer, const Rect &area) override;
		void redraw_all_later() override;
		void free_on_worker(std::shared_ptr<const void> unneeded) override {
			node_.stream_->free_on_worker(std::move(unneeded));
		}
		void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) override;
		void recycle_soon() override { node_.call_deferred("_recycle_scenes"); }

	private:
		TerrainScatter3D &node_;
	};

	static void bind_streaming();
	static void bind_places();
	static void bind_queries();
	static void bind_changes();
	static void bind_signals();

	/// Returns a copy, so that the caller keeps the object alive during a call even if the node is
	/// freed.
	std::shared_ptr<ScatterGameplay> gameplay() const { return gameplay_; }
	TileDisplay &display() { return stream_->display(); }
	const TileDisplay &display() const { return stream_->display(); }

	void start();
	void stop();
	void check_transform();
	void check_load();
	void process_frame();
	void work(std::chrono::steady_clock::time_point start);
	void dissolve(std::chrono::steady_clock::time_point start);
	void patch_in_steps(std::chrono::steady_clock::time_point deadline);
	void emit_events();
	Status prepare();
	bool read_models(std::chrono::steady_clock::time_point deadline) const;
	bool models_are_read(std::chrono::steady_clock::time_point deadline) const;
	void warn_of_stripped();
	void refresh();
	void apply_changes();
	bool waits_for_ground() const;
	void check_layers();
	void mark_edited();
	void change_references(const ReferenceChange &change);
	void mark_instances_changed(std::uint32_t layer, const Rect &area);
	void mark_all_instances_changed();
	void mark_dirty();
	void mark_ground_dirty();
	void mark_ground_edited(const godot::Rect2 &p_rect);
	void mark_ground_changed(glm::dvec2 position);
	void mark_area_edited(const godot::Rect2 &) { mark_edited(); }
	void schedule_patch();
	void patch_now();
	void parse_navigation(const godot::Ref<godot::NavigationMesh> &p_mesh,
			const godot::Ref<godot::NavigationMeshSourceGeometryData3D> &p_geometry, godot::Node *p_node);
	void recycle_scenes() { gameplay()->recycle_scenes(); }
	void watch_ground(bool p_watch);
	void use_resources();

	/// Rereads the lists first, because scripts may have modified them in place.
	const godot::TypedArray<ScatterLayer> &all_layers() const {
		node_layers_.update(layers_, biomes_.ptr());
		return node_layers_.by_index();
	}
	LayerWorld layer_world(const StateEdits &state_edits);
	TileMaker tile_maker() const;
	TileMaker worker_tile_maker() const;
	DrawLimits draw_limits() const;
	bool follows() const;
	CurrentViewers current_viewers() const;
	std::vector<glm::dvec3> near_centers(const CurrentViewers &viewers) const;
	void set_fade_viewers(const CurrentViewers &viewers);
	void move_world();
	static godot::Dictionary to_dictionary(const FrameTimes &times);
	godot::String ground_problem();
	LayerExplainer layer_explainer() const;
	void explain_layer(const godot::Ref<ScatterLayer> &p_layer, const std::shared_ptr<ScatterGameplay> &gameplay,
			LayerExplanation &r_explanation);
	void explain_changes(const LayerSnapshot &layer, LayerExplanation &r_explanation) const;
	void explain_drawing(const LayerSnapshot &layer, LayerExplanation &r_explanation) const;
	template <class Position, class Find, class Evaluate>
	godot::PackedFloat32Array values_of(
			const char *p_method, const godot::Variant *p_layer, const Find &find, const Evaluate &evaluate);
	template <class Evaluate>
	godot::PackedFloat32Array map_of(const char *p_method, const godot::Variant *p_layer, const godot::Rect2 &p_rect,
			const godot::Vector2i &p_size, const Evaluate &evaluate);
	godot::Ref<ScatterTile> build(const char *p_method, const godot::Variant &p_layer,
			const std::function<Rect(const LayerSnapshot &)> &rect_of);
	bool find_layer_index(const char *p_method, const godot::Variant &p_layer, std::uint32_t &r_index) const;

	int64_t seed_ = 0;
	godot::TypedArray<ScatterLayer> layers_;
	godot::Ref<ScatterBiomeMap> biomes_;
	mutable NodeLayers node_layers_; ///< Updated by all_layers().
	bool water_enabled_ = false;
	double water_level_ = 0.0;
	std::shared_ptr<LayerWatch> layer_watch_ = std::make_shared<LayerWatch>(this);
	godot::Ref<ScatterGround> ground_;
	ViewerSettings viewers_;
	godot::StringName interaction_group_ = "scatter_interaction";
	int64_t frame_budget_usec_ = 500;
	double quality_ = 1.0;
	int64_t preview_instances_ = 250000;
	int64_t max_multimeshes_ = 8192;
	glm::dvec3 world_offset_{0.0}; ///< The property.
	bool local_coords_ = false;
	WorldFrame frame_; ///< The frame in use, derived from the two members above and the transform.

	Host host_{*this};
	std::shared_ptr<ScatterGameplay> gameplay_ = std::make_shared<ScatterGameplay>(host_);
	std::shared_ptr<ScatterStream> stream_ = std::make_shared<ScatterStream>(gameplay_->world());
	NavigationParse navigation_;
	std::shared_ptr<SynchronousBuilder> synchronous_builder_ = std::make_shared<SynchronousBuilder>();
	LayerList layer_list_;
	InstanceLoad instance_load_;
	SceneUse scene_use_;              ///< The resources in use while the node is in the tree.
	bool warned_of_stripped_ = false; ///< True once the warning about stripped resources is printed.
	LayerPreviews previews_;
	FadeViewers fade_viewers_;
	WindTime wind_time_;
	RegionRegister regions_;
	RowPaths row_paths_;
	Planet region_planet_; ///< The planet for which the regions were last read.
	/// The layers before the last change. Kept until the signals for tiles that the change has
	/// hidden are emitted.
	SharedLayers former_layers_;
	/// The names of the layers by index. If they change, regions must update their warnings.
	godot::PackedStringArray layer_names_;
	std::shared_ptr<const Terrain> ground_snapshot_;
	/// The area in which the ground has changed since `ground_snapshot_` was taken.
	EditedArea ground_change_{.everywhere = true, .areas = {}};
	/// The changes, since the last update of the layers, to instances on whose models other layers
	/// grow.
	StateEdits state_edits_;
	std::chrono::steady_clock::duration frame_time_{0}; ///< The main-thread time of the last frame.
	bool patch_scheduled_ = false;
	bool was_recentered_ = false; ///< True if `frame_.offset` has changed since the regions were read.
	bool is_running_ = false;
	bool was_inside_ = false; ///< True if the node has ever been in the tree.
	bool is_dirty_ = true;
	bool was_settled_ = true;
	/// The number of problems of instance_load_ in the current configuration warnings.
	int64_t load_problems_ = 0;
	/// The result of is_displaced for the current configuration warnings.
	bool is_displaced_ = false;
};

} // namespace thicket
