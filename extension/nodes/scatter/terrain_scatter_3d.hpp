#pragma once

#include "nodes/scatter/layer_list.hpp"
#include "nodes/gameplay/collision_ring.hpp"
#include "nodes/gameplay/instance_world.hpp"
#include "nodes/gameplay/query_requests.hpp"
#include "nodes/gameplay/scene_ring.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/layer/layer_watch.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/scatter_stream.hpp"
#include "nodes/region/region_register.hpp"
#include "nodes/region/scatter_region_3d.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/vector2i.hpp>

#include <chrono>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace thicket {

/// Streams layers of instances onto a terrain, around viewers. Works in the editor as in the game. Instances stand in
/// world space: the node's own transform does not move them. What it shows is never saved.
class TerrainScatter3D : public godot::Node3D, public RegionHost {
	GDCLASS(TerrainScatter3D, godot::Node3D)

public:
	TerrainScatter3D();
	~TerrainScatter3D() override;

	/// Any 64-bit number; another seed places everything anew.
	void set_seed(int64_t p_seed);
	int64_t get_seed() const;

	/// Null entries keep their place and show nothing. The array is shared with scripts, and what they do to it counts.
	void set_layers(const godot::TypedArray<ScatterLayer> &p_layers);
	godot::TypedArray<ScatterLayer> get_layers() const;

	/// Null: nothing is shown.
	void set_terrain(const godot::Ref<ScatterTerrain> &p_terrain);
	godot::Ref<ScatterTerrain> get_terrain() const;

	/// Node3Ds to stream around; none for the camera of the viewport, in the editor the editor's own.
	void set_viewers(const godot::TypedArray<godot::NodePath> &p_viewers);
	godot::TypedArray<godot::NodePath> get_viewers() const;

	/// By place in the list of viewers, how far each sees: times the view distance of each layer, 0 or more and finite.
	/// What is missing is 1. A list with anything else in it is refused.
	void set_viewer_radius_scales(const godot::PackedFloat32Array &p_scales);
	godot::PackedFloat32Array get_viewer_radius_scales() const { return viewer_radius_scales_; }

	/// The world's meters at the engine's origin, each at most 1e12 from 0: world = engine + world_offset. Nothing is made or
	/// uploaded anew for another one; all positions that the node takes and gives are the engine's.
	void set_world_offset(const godot::Vector3 &p_offset);
	godot::Vector3 get_world_offset() const;
	glm::dvec3 world_offset() const override { return world_offset_; }

	/// Microseconds of the main thread a frame, 1 to 1e6.
	void set_upload_budget_usec(int64_t p_budget);
	int64_t get_upload_budget_usec() const;

	/// The share of every tile that is drawn, 0 to 1: those instances that would also stand at that density. No tile is made
	/// or uploaded anew for it.
	void set_quality(double p_quality);
	double get_quality() const;

	/// The most instances that are drawn in the editor, 0 to 1e9; all tiles are thinned alike to keep to it.
	void set_preview_instances(int64_t p_count);
	int64_t get_preview_instances() const;

	/// Makes all tiles anew; what stands stays until its successor is ready.
	void regenerate();

	/// True when every wanted tile is shown.
	bool is_idle() const;
	godot::Dictionary get_stats() const;

	/// What is drawn of a tile, read back from the RenderingServer. Empty or 0 for a tile that is not shown.
	godot::Array get_shown_tiles(int64_t p_layer) const;
	godot::Vector3 get_tile_origin(int64_t p_layer, const godot::Vector2i &p_tile);
	godot::Array get_tile_buffers(int64_t p_layer, const godot::Vector2i &p_tile);
	godot::Array get_tile_multimeshes(int64_t p_layer, const godot::Vector2i &p_tile);
	godot::Array get_tile_ids(int64_t p_layer, const godot::Vector2i &p_tile);
	int64_t get_tile_digest(int64_t p_layer, const godot::Vector2i &p_tile);

	/// What stands in a half-open rectangle of world x and z, made at once on the calling thread, the main one: origin
	/// (Vector3), and for each mesh of the layer its buffer (PackedFloat32Array, as get_tile_buffers), ids
	/// (PackedInt64Array) and mesh (Mesh or null). A layer that does not exist and a rectangle that TileSampler refuses
	/// print an error and give empty arrays.
	godot::Dictionary build_rect(int64_t p_layer, const godot::Rect2 &p_rect);

	/// What a game has changed: removed and hand-placed instances, and data. Null until the first change. One that was made for another
	/// seed, radius or number of levels is refused.
	void set_state(const godot::Ref<ScatterState> &p_state);
	godot::Ref<ScatterState> get_state() const { return state_; }

	/// Node3Ds of this group are near: bodies and scenes stand around them as around viewers.
	void set_body_group(const godot::StringName &p_group) { body_group_ = p_group; }
	godot::StringName get_body_group() const { return body_group_; }

	/// What stands, on places that are loaded and on all others: see InstanceQuery. `p_layers` are places in the list of layers, none for
	/// all; a predicate takes (id, layer, transform) and says whether that instance counts. What is refused prints an error, and the
	/// answer is empty.
	godot::Dictionary query_rect(
			const godot::Rect2 &p_rect, const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	godot::Dictionary query_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	godot::Dictionary query_ray(const godot::Vector3 &p_from, const godot::Vector3 &p_to,
			const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	godot::Dictionary query_nearest(const godot::Vector3 &p_position, double p_max_distance,
			const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	godot::Dictionary get_instance(int64_t p_id);
	bool has_instance(int64_t p_id);

	/// The instance that a body of the PhysicsServer3D stands for, or stood for until some frames ago; 0 for none.
	int64_t get_body_instance(const godot::RID &p_body) const;

	/// The same on workers: a number for `query_finished`, which comes in a later frame; 0 for what is refused.
	int64_t request_rect(const godot::Rect2 &p_rect, const godot::PackedInt32Array &p_layers);
	int64_t request_sphere(const godot::Vector3 &p_center, double p_radius, const godot::PackedInt32Array &p_layers);
	bool cancel_request(int64_t p_request);

	/// Changes. False, or 0, for what does not stand, stands already, or is refused.
	bool remove_instance(int64_t p_id);
	bool restore_instance(int64_t p_id);
	godot::PackedInt64Array remove_in_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	int64_t add_instance(int64_t p_layer, const godot::Transform3D &p_transform, int64_t p_mesh);
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);
	godot::Variant get_instance_data(int64_t p_id) const;

	/// The scene that stands in place of an instance; null for none.
	godot::Node3D *get_scene(int64_t p_id) const;

	/// The same, the caller's from now on. The mesh is back, unless the instance is removed.
	godot::Node3D *take_scene(int64_t p_id);

	// For regions below this node.
	void add_region(ScatterRegion3D *p_region) override;
	void remove_region(ScatterRegion3D *p_region) override;
	void region_changed(const ScatterRegion3D *p_region) override;
	godot::String layer_problem(const godot::Variant &p_reference) const override;

	/// What keeps the node from showing what it should, a sentence each; the editor shows them as warnings.
	godot::PackedStringArray get_problems() const;
	godot::PackedStringArray _get_configuration_warnings() const override { return get_problems(); }

protected:
	static void _bind_methods();
	void _notification(int p_what);

private:
	static void bind_queries();
	static void bind_changes();
	static void bind_scenes();

	/// Hears of the state's changes for the node.
	class StateWatch final : public StateListener {
	public:
		explicit StateWatch(TerrainScatter3D &node) : node_(node) {}
		void state_changed(std::span<const InstanceChange> changes) override { node_.state_changed(changes); }

	private:
		TerrainScatter3D &node_;
	};

	void state_changed(std::span<const InstanceChange> changes);
	void emit_change(const InstanceChange &change, std::uint32_t place);
	void update_world(const std::vector<EditedArea> &outdated);
	std::uint64_t look_around_near();
	void answer_requests();
	SceneHost scene_host();
	void update_scenes();
	bool step_scenes(std::chrono::steady_clock::time_point deadline);
	void recycle_scenes();
	void schedule_patch();
	void patch_now();
	bool prepare_query(const char *p_method);
	template <class Query>
	void ask(const char *p_method, Query &&query);
	TileMaker tile_maker() const;
	std::vector<PlacedInstance> find_in_sphere(const char *p_method, const godot::Vector3 &p_center, double p_radius,
			const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate);
	std::vector<PlacedInstance> find_by_id(const char *p_method, int64_t p_id, bool even_removed);
	bool remove_found(const PlacedInstance &instance);
	Status check_state(const ScatterState &state) const;
	Status claim(std::uint32_t place);
	void claim_layers();
	int64_t request(const char *p_method, const std::variant<Rect, QueryRequests::Sphere> &place,
			const godot::PackedInt32Array &p_layers);
	std::int64_t place_of(std::uint64_t id) const;
	void start();
	void stop();
	void process_frame();
	void mark_edited();
	void mark_dirty();
	void mark_ground_dirty();
	void mark_ground_edited(const godot::Rect2 &p_rect);
	void mark_area_edited(const godot::Rect2 &p_rect);
	void refresh();
	void add_layer_problems(godot::PackedStringArray &r_problems) const;
	Status find_snapshot(int64_t p_layer, SharedSnapshot &r_layer);
	void emit_events();
	DrawLimits draw_limits() const;
	std::vector<Viewer> find_viewers() const;
	godot::Node3D *active_camera() const;
	godot::Ref<ScatterLayer> layer_at(int64_t p_place) const;
	const DisplayedTile *tile_at(int64_t p_layer, const godot::Vector2i &p_tile);
	void notice_layers();
	void watch_terrain(bool p_watch);

	int64_t seed_ = 0;
	godot::TypedArray<ScatterLayer> layers_;
	LayerWatch layer_watch_{this};
	godot::Ref<ScatterTerrain> terrain_;
	godot::TypedArray<godot::NodePath> viewers_;
	godot::PackedFloat32Array viewer_radius_scales_;
	int64_t upload_budget_usec_ = 500;
	double quality_ = 1.0;
	int64_t preview_instances_ = 250000;

	godot::Ref<ScatterState> state_;
	godot::StringName body_group_ = "scatter_bodies";
	StateWatch state_watch_{*this};
	glm::dvec3 world_offset_{0.0}; ///< Of the engine's origin in the world, meters.

	std::shared_ptr<InstanceWorld> world_ = std::make_shared<InstanceWorld>();
	QueryRequests requests_;
	std::vector<std::pair<std::int64_t, godot::Dictionary>> answers_; ///< To be told at the end of the frame.
	CollisionRing collision_;
	std::vector<NearRing *> rings_{&collision_, &scenes_};
	bool patch_scheduled_ = false;

	ScatterStream stream_{*world_};
	SceneRing scenes_{scene_host()};
	LayerList layer_list_;
	RegionRegister regions_;
	godot::PackedStringArray layer_names_; ///< By index, as regions were told of them last.
	std::shared_ptr<const Terrain> ground_;
	EditedArea ground_change_{.everywhere = true, .areas = {}}; ///< Since `ground_` was taken.
	std::chrono::steady_clock::duration frame_time_{0};         ///< Of the main thread, in the last frame.
	bool recentered_ = false; ///< `world_offset_` was changed since regions were read.
	bool running_ = false;
	bool dirty_ = true;
	bool was_idle_ = true;
};

} // namespace thicket
