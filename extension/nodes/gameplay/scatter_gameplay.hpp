#pragma once

#include "core/base/world_frame.hpp"
#include "core/query/instance_world.hpp"
#include "core/query/query_requests.hpp"
#include "nodes/gameplay/collision_ring.hpp"
#include "nodes/gameplay/scatter_instances.hpp"
#include "nodes/gameplay/scatter_request.hpp"
#include "nodes/gameplay/scatter_snapshot.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/scene_ring.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/rect2.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace thicket {

/// The services that a ScatterGameplay needs from its node.
class GameplayHost {
public:
	/// Returns the node, which is the parent of scenes and emits the signals.
	virtual godot::Node3D *node() = 0;

	/// Applies the settings that changed in this frame. Returns an error if there is nothing to
	/// query. May run scripts.
	virtual Status prepare() = 0;

	/// Calls `set_world_frame` if the node has moved the world since the last frame.
	virtual void move_world() = 0;

	/// Returns a function that generates tiles from the current layers and ground. Any number of
	/// threads may call it concurrently. Call `prepare` first.
	virtual TileMaker make_worker_maker() = 0;

	/// Sets the changes that the display applies from now on; null for none.
	virtual void set_overlay(const InstanceState *state) = 0;

	/// Redraws an area of a layer, or everything, before this frame is drawn.
	virtual void redraw(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all() = 0;

	/// Redraws an area of a layer, or everything, over the next frames, within the frame budget.
	virtual void redraw_later(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all_later() = 0;

	/// Frees a large object on another thread.
	virtual void free_on_worker(std::shared_ptr<const void> object) = 0;
	/// Hides the mesh of an instance, or draws it again. `area` must contain the instance's point.
	virtual void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) = 0;

	/// Schedules a call to ScatterGameplay::recycle_scenes before this frame is drawn and before
	/// the next physics step.
	virtual void recycle_soon() = 0;

protected:
	GameplayHost() = default;
	~GameplayHost() = default;
	GameplayHost(const GameplayHost &) = default;
	GameplayHost &operator=(const GameplayHost &) = default;
};

struct NavigationBake;

/// Implements a TerrainScatter3D's queries and changes for games, and manages the bodies and scenes
/// near viewers. Use it only on the main thread, except for methods that permit any thread.
///
/// Many methods run scripts: predicates, grounds, signal handlers and scenes. A script may change
/// or free anything, so every caller must hold a shared pointer to this object. After every call
/// that runs scripts, the caller must check whether the node was freed (`alive`) or has left the
/// tree (`run`). The script may also have replaced layers, state and tiles.
class ScatterGameplay final : public StateListener, public std::enable_shared_from_this<ScatterGameplay> {
public:
	explicit ScatterGameplay(GameplayHost &host);
	~ScatterGameplay() override;

	// Events of the node.

	/// Detaches this object from the node, which it never accesses again. Call it when the node is
	/// freed.
	void detach();
	bool alive() const { return host_ != nullptr; }

	/// Starts the work in a world that the node has entered. `space` is the physics space for the
	/// bodies. If it is invalid, there are no bodies.
	void start(const godot::RID &space, std::uint64_t node_id);

	/// Ends the work in a world that the node has left.
	void stop();

	/// Returns a number that changes whenever the node enters or leaves a world.
	std::uint64_t run() const { return run_; }

	/// Removes everything immediately: frees bodies and scenes, discards tiles, and completes
	/// requests without an answer.
	void clear();

	/// Removes everything from a node that stays in the tree without layers or a ground. Bodies and
	/// scenes are removed step by step, nearest first.
	void retire();

	/// Sets the layers. `layers` are the snapshots of `new_layers`, with the same indices.
	/// `outdated` has an area for each layer whose tiles are regenerated.
	void set_layers(SharedLayers new_layers, const std::vector<SharedSnapshot> &layers,
			std::span<const EditedArea> outdated, TileMaker maker);

	/// Returns the layers as last set. The layer indices of instances refer to this list.
	const SharedLayers &listed_layers() const { return listed_layers_; }
	void set_world_frame(const WorldFrame &frame);

	/// Returns the relation between the engine's space and the world, at the node's current transform.
	const WorldFrame &world_frame();
	InstanceWorld &world() { return world_; }
	CollisionRing &collision() { return collision_; }
	SceneRing &scenes() { return scenes_; }
	const CollisionRing &collision() const { return collision_; }
	const SceneRing &scenes() const { return scenes_; }

	// Work of each frame.

	/// Advances the state's clock by `seconds`, once per `frame`. Runs scripts.
	void advance(double seconds, std::uint64_t frame);

	/// Sets the positions (world meters) around which bodies and scenes are placed.
	void find_changes(std::span<const glm::dvec3> centers);

	/// Processes the requests and cancellations that other threads have made since the last frame.
	/// Runs scripts.
	void take_requests();

	/// Answers the requests whose tiles are ready. Runs no scripts.
	void answer_requests();

	/// Applies the predicates of finished requests to their answers and emits their signals. Runs
	/// scripts.
	void complete_requests();

	/// Adds and removes scenes, and emits the signals of large changes, until `deadline`. Does at
	/// least one step of each, so that they always progress. Runs scripts.
	void work_until(std::chrono::steady_clock::time_point deadline);
	void recycle_scenes();

	/// Returns true if all bodies and scenes are up to date and all signals are emitted.
	bool settled() const { return collision_.settled() && scenes_.settled() && backlog_.empty(); }

	/// Returns true if `find_changes` with these positions would find nothing to do.
	bool follows(std::span<const glm::dvec3> centers) const;

	// The templates of script_queries.hpp call the following functions.

	static std::string name_of(const char *p_method) { return std::string("TerrainScatter3D.") + p_method; }

	/// Prepares a query and returns the layers. Returns null if the node was freed. If there is
	/// nothing to query, prints an error and returns null. Runs scripts.
	SharedLayers prepare(const char *p_method);
	godot::String find_queried_layers(const godot::Variant &p_layers, std::vector<std::uint32_t> &r_indices) const {
		return find_layers(*listed_layers_, p_layers, r_indices);
	}

	/// Runs a query and generates missing tiles for it. Keeps the state alive during the call. Call
	/// `prepare` first. On failure, prints an error and returns false.
	bool answer(const char *p_method, const PreparedQuery &query);

	// Queries. For `p_layers`, see find_layers. A predicate receives (id, layer, transform) and
	// returns whether to include that instance. An invalid query prints an error and returns an
	// empty result.

	godot::Ref<ScatterInstances> query_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterInstances> query_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterInstance> query_ray(const godot::Vector3 &p_from, const godot::Vector3 &p_to,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterInstance> query_nearest(const godot::Vector3 &p_position, double p_max_distance,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterInstance> get_instance(int64_t p_id);
	bool has_instance(int64_t p_id);

	/// Creates a snapshot of the current world, for queries on other threads. If there is nothing
	/// to query, prints an error and returns an empty snapshot.
	godot::Ref<ScatterSnapshot> make_snapshot();

	/// Any thread may call the request methods while the node exists. Requests from other threads
	/// wait for `take_requests`, which also prints their errors.
	godot::Ref<ScatterRequest> request_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterRequest> request_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);

	/// Adds the instances in the baked box as obstructions to the source geometry of a navigation
	/// mesh, if their layers affect navigation. Runs scripts.
	void add_obstructions(const NavigationBake &bake);

	// Changes. These methods return false or 0 if the instance does not exist or already is in the
	// requested state, or if the change is rejected.

	void set_state(const godot::Ref<ScatterState> &p_state);
	godot::Ref<ScatterState> get_state() const { return state_; }

	/// Returns an error if the state's IDs refer to another point set.
	Status check_state(const ScatterState &state) const;
	bool remove_instance(int64_t p_id);
	bool restore_instance(int64_t p_id);
	godot::PackedInt64Array remove_in_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	int64_t add_instance(const godot::Variant &p_layer, const godot::Transform3D &p_transform, int64_t p_mesh);

	/// Adds many instances. Each has 12 floats, as in MultiMesh.buffer. `p_meshes` has a mesh index
	/// for each instance; if it is empty, all use the first mesh. Adds all instances or none.
	godot::PackedInt64Array add_instances(const godot::Variant &p_layer, const godot::PackedFloat32Array &p_transforms,
			const godot::PackedInt32Array &p_meshes);
	godot::PackedInt64Array remove_instances(const godot::PackedInt64Array &p_ids);
	int64_t set_instance_transform(int64_t p_id, const godot::Transform3D &p_transform);
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);
	godot::Variant get_instance_data(int64_t p_id) const;

	// ScatterState calls the following functions.
	bool displays(std::uint64_t id) const override;
	bool remove_from(const ScatterState *state, std::uint64_t id, double until) override;
	bool restore_in(const ScatterState *state, std::uint64_t id) override;
	bool set_data_in(const ScatterState *state, std::uint64_t id, const godot::Variant &p_data) override;
	SharedLayers layers() const override { return listed_layers_; }
	void state_changed(const SharedChanges &changes) override;
	void notify_changes(const SharedChanges &changes) override;

	/// The maximum number of instance changes that one call completes. After larger changes,
	/// signals, drawing and scenes are spread over the next frames.
	static constexpr std::size_t max_per_call = 1024;

	/// The maximum number of removed or moved instances whose bodies and scenes a call removes
	/// before it returns. The rest are removed step by step.
	static constexpr std::size_t max_dropped_at_once = 128;

private:
	/// A sphere in engine space, not world space.
	struct SphereInScene {
		godot::Vector3 center;
		double radius = 0.0;
	};

	/// A request as a script made it, on any thread.
	struct PendingRequest {
		const char *method = "";
		std::variant<godot::Rect2, SphereInScene> area;
		godot::Variant layers;
		godot::Callable predicate;
		godot::Ref<ScatterRequest> request;
	};

	/// A request whose tiles are being generated.
	struct OpenRequest {
		const char *method = "";
		godot::Callable predicate;
		godot::Ref<ScatterRequest> request;
	};

	/// A request whose tiles are ready, but whose predicate has not been applied yet.
	struct AnsweredRequest {
		OpenRequest request;
		FoundInstances instances;
		SharedLayers layers; ///< The layer indices of the instances refer to this list.
	};

	/// Changes whose signals are emitted over several frames.
	struct UnreportedChanges {
		SharedChanges changes;
		std::size_t reported_count = 0;
	};

	/// The node's signals, one for each kind of change. The StringNames are stored, because
	/// creating one costs as much as removing an instance.
	struct Signals {
		const godot::StringName &of(InstanceChangeKind kind) const;

		const godot::StringName none{}; ///< The signal of changes that emit none.
		const godot::StringName removed = "instance_removed";
		const godot::StringName restored = "instance_restored";
		const godot::StringName added = "instance_added";
		const godot::StringName moved = "instance_moved";
		const godot::StringName data = "instance_data_changed";
	};

	SceneHost scene_host();
	std::vector<PlacedInstance> find_by_id(const char *p_method, int64_t p_id, bool include_removed);
	godot::Ref<ScatterRequest> request(PendingRequest pending);
	void open_request(const PendingRequest &pending);
	void abandon_requests();
	void renumber_requests(const ListedLayers &new_layers);

	void add_obstructions(
			const NavigationBake &bake, const Rect &ground, std::uint32_t layer, const SharedSnapshot &snapshot);
	std::vector<std::uint64_t> remove_all(std::span<const PlacedInstance> instances, double until = regrowth_of_layer);
	bool set_data(std::uint64_t id, bool exists, const godot::Variant &p_data);
	bool find_layer_to_add_to(const char *p_method, const godot::Variant &p_layer, std::uint32_t &r_layer);
	void claim_layers();
	Status claim(std::uint32_t layer);
	std::int64_t layer_index_of(std::uint64_t id) const;
	Rect area_of(std::uint64_t id, glm::dvec3 position, std::uint32_t layer) const;
	bool is_no_longer_placed(std::uint64_t id) const;
	void redraw_later(const StateChanges &changes);
	const PlacedInstance *find_changing(std::uint64_t id);
	void notify(const InstanceChange &change);
	void emit_backlog(std::chrono::steady_clock::time_point deadline);
	bool still_applies(const InstanceChange &change) const;

	const Signals signals_;
	GameplayHost *host_; ///< The services of the node. Null once the node is freed.
	bool running_ = false;
	std::uint64_t run_ = 0;
	WorldFrame frame_;
	std::vector<SharedSnapshot> layers_;
	SharedLayers listed_layers_ = std::make_shared<const ListedLayers>(godot::TypedArray<ScatterLayer>());
	InstanceWorld world_;
	godot::Ref<ScatterState> state_;
	std::deque<UnreportedChanges> backlog_;
	/// The instances that this node is currently removing or restoring, in the order of their
	/// signals. Excludes those whose signals have been emitted.
	std::span<const PlacedInstance> changing_instances_;

	std::mutex pending_mutex_;
	std::vector<PendingRequest> pending_; ///< Requests from other threads. Guarded by `pending_mutex_`.
	QueryRequests requests_;
	std::map<std::int64_t, OpenRequest> open_requests_; ///< The open requests, keyed by their numbers in `requests_`.
	std::vector<AnsweredRequest> answered_requests_;

	CollisionRing collision_;
	SceneRing scenes_;
	std::array<NearRing *, 2> rings_{&collision_, &scenes_};
};

} // namespace thicket
