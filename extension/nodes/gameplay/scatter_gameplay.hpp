#pragma once

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
	/// The parent of scenes, and the emitter of the signals.
	virtual godot::Node3D *node() = 0;

	/// Applies the settings that were changed in this frame. Returns an error if there is nothing to query. May run
	/// scripts.
	virtual Status prepare() = 0;

	/// Generates tiles on any thread, several at once, from the current layers and ground. Call `prepare` first.
	virtual TileMaker make_worker_maker() = 0;

	/// Sets the changes that the display applies from now on; null for none.
	virtual void set_overlay(const InstanceState *state) = 0;

	/// Redraws an area of a layer before this frame is drawn, because its display has changed.
	virtual void redraw(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all() = 0;

	/// Redraws an area of a layer, or everything, over the next frames and within their budget.
	virtual void redraw_later(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all_later() = 0;

	/// Frees a large object on a different thread.
	virtual void let_go(std::shared_ptr<const void> unneeded) = 0;
	virtual void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) = 0;

	/// Schedules ScatterGameplay::recycle_scenes, before this frame is drawn and before bodies move again.
	virtual void recycle_soon() = 0;

protected:
	GameplayHost() = default;
	~GameplayHost() = default;
	GameplayHost(const GameplayHost &) = default;
	GameplayHost &operator=(const GameplayHost &) = default;
};

struct NavigationBake;

/// A game's queries and changes of a TerrainScatter3D, and the nearby bodies and scenes. Main thread only.
///
/// Many methods run scripts: predicates, grounds, signal handlers, scenes. These scripts may do anything. So every
/// caller keeps its own shared pointer to this object. After every call that runs scripts, the caller checks whether
/// the node was freed (`alive`) or has left the tree (`run`). Layers, state and tiles may have been replaced, too.
class ScatterGameplay final : public StateListener, public std::enable_shared_from_this<ScatterGameplay> {
public:
	explicit ScatterGameplay(GameplayHost &host);
	~ScatterGameplay() override;

	// The node.

	/// The node is being freed and is never accessed from now on.
	void detach();
	bool alive() const { return host_ != nullptr; }

	/// Starts the work of a node that has entered a world. `space` contains its bodies (invalid if there is none).
	void start(const godot::RID &space, std::uint64_t node_id);

	/// The node has left its world.
	void stop();

	/// Changes whenever the node enters or leaves a world.
	std::uint64_t run() const { return run_; }

	/// Removes everything: frees bodies and scenes, forgets tiles, and completes requests without an answer.
	void clear();

	/// Removes everything from a node that stays in the tree without layers or ground. Bodies and scenes are removed
	/// step by step, the nearest first.
	void retire();

	/// `listed` has the layers of the snapshots, by the same indices.
	void set_layers(SharedLayers listed, const std::vector<SharedSnapshot> &layers,
			std::span<const EditedArea> outdated, TileMaker maker);

	/// The layers by the indices of the world's instances, as last set.
	const SharedLayers &listed_layers() const { return listed_; }
	void set_world_offset(glm::dvec3 offset);
	glm::dvec3 world_offset() const { return offset_; }
	InstanceWorld &world() { return world_; }
	CollisionRing &collision() { return collision_; }
	SceneRing &scenes() { return scenes_; }
	const CollisionRing &collision() const { return collision_; }
	const SceneRing &scenes() const { return scenes_; }

	// The frame.

	/// Advances the state's clock. Runs scripts.
	void advance(double seconds, std::uint64_t frame);

	/// Sets the world positions around which bodies and scenes are placed.
	void look_around(std::span<const glm::dvec3> centers);

	/// Processes the requests and cancellations that other threads have made since the last frame. Runs scripts.
	void take_requests();

	/// Answers the requests whose tiles are ready. Runs no scripts.
	void answer_requests();

	/// Applies the predicates of finished requests to their answers, and emits their signals. Runs scripts.
	void complete_requests();

	/// Adds and removes scenes, and emits the signals of large changes, until `deadline`. Does at least one step of
	/// each. Runs scripts.
	void work_until(std::chrono::steady_clock::time_point deadline);
	void recycle_scenes();

	/// True if bodies, scenes and signals are all up to date.
	bool settled() const { return collision_.settled() && scenes_.settled() && backlog_.empty(); }

	/// True if `look_around` would find nothing to do for these positions.
	bool follows(std::span<const glm::dvec3> centers) const;

	// The templates of script_queries.hpp call these functions.

	static std::string name_of(const char *p_method) { return std::string("TerrainScatter3D.") + p_method; }

	/// Prepares a query. Returns null if the node has been freed, and null with an error if there is nothing to query.
	/// Runs scripts.
	SharedLayers prepare(const char *p_method);
	godot::String find_queried(const godot::Variant &p_layers, std::vector<std::uint32_t> &r_indices) const {
		return find_layers(*listed_, p_layers, r_indices);
	}

	/// Runs a query, and generates missing tiles for it. Keeps the state alive in the meantime. Call `prepare` first.
	bool ask(const char *p_method, const AskedQuery &query);

	// Queries. `p_layers` is as in find_layers. A predicate gets (id, layer, transform) and returns whether that
	// instance counts. A refused query prints an error and returns an empty result.

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

	/// The current world, for queries on other threads. Empty, with an error, if there is nothing to query.
	godot::Ref<ScatterSnapshot> make_snapshot();

	/// Any thread may call these while the node exists. Requests of other threads wait for `take_requests`, which also
	/// prints their errors.
	godot::Ref<ScatterRequest> request_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterRequest> request_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);

	/// Adds obstructions to the source geometry of a navigation mesh: the instances in the baked box whose layers
	/// affect navigation. Runs scripts.
	void add_obstructions(const NavigationBake &bake);

	// Changes. These methods return false or 0 if the instance does not exist, is already in the requested state, or if
	// the change is refused.

	void set_state(const godot::Ref<ScatterState> &p_state);
	godot::Ref<ScatterState> get_state() const { return state_; }

	/// Refuses a state whose IDs refer to different points.
	Status check_state(const ScatterState &state) const;
	bool remove_instance(int64_t p_id);
	bool restore_instance(int64_t p_id);
	godot::PackedInt64Array remove_in_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	int64_t add_instance(const godot::Variant &p_layer, const godot::Transform3D &p_transform, int64_t p_mesh);

	/// Adds many instances, with 12 floats each as in the buffer of a MultiMesh. `p_meshes` has a mesh index for each
	/// instance; if it is empty, all use the first mesh. Adds all instances or none.
	godot::PackedInt64Array add_instances(const godot::Variant &p_layer, const godot::PackedFloat32Array &p_transforms,
			const godot::PackedInt32Array &p_meshes);
	godot::PackedInt64Array remove_instances(const godot::PackedInt64Array &p_ids);
	int64_t set_instance_transform(int64_t p_id, const godot::Transform3D &p_transform);
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);
	godot::Variant get_instance_data(int64_t p_id) const;

	// A ScatterState calls these functions.
	bool displays(std::uint64_t id) const override;
	bool remove_from(const ScatterState *state, std::uint64_t id, double until) override;
	bool restore_in(const ScatterState *state, std::uint64_t id) override;
	bool set_data_in(const ScatterState *state, std::uint64_t id, const godot::Variant &p_data) override;
	SharedLayers layers() const override { return listed_; }
	void state_changed(const SharedChanges &changes) override;
	void tell_changes(const SharedChanges &changes) override;

	/// The largest change that is completed in one call. Signals, drawing and scenes of larger changes follow over the
	/// next frames.
	static constexpr std::size_t most_at_once = 1024;

	/// The largest number of instances whose bodies and scenes a call removes before it returns, among those that it
	/// removes or moves.
	static constexpr std::size_t most_dropped_at_once = 128;

private:
	/// In the engine's space, not the world's.
	struct SphereInScene {
		godot::Vector3 center;
		double radius = 0.0;
	};

	/// A request in its original form, from any thread.
	struct Wanted {
		const char *method = "";
		std::variant<godot::Rect2, SphereInScene> area;
		godot::Variant layers;
		godot::Callable predicate;
		godot::Ref<ScatterRequest> request;
	};

	/// A request whose tiles are being made.
	struct Open {
		const char *method = "";
		godot::Callable predicate;
		godot::Ref<ScatterRequest> request;
	};

	/// An answered request whose predicate is still to be applied.
	struct Answered {
		Open open;
		FoundInstances found;
		SharedLayers layers; ///< By the indices of the found instances.
	};

	/// Changes whose signals are emitted over several frames.
	struct Untold {
		SharedChanges changes;
		std::size_t told = 0;
	};

	/// The node's signals, one for each kind of change. The names are stored, because creating a name costs as much as
	/// a removal.
	struct Signals {
		const godot::StringName &of(InstanceChangeKind kind) const;

		const godot::StringName none{}; ///< For changes that emit no signal.
		const godot::StringName removed = "instance_removed";
		const godot::StringName restored = "instance_restored";
		const godot::StringName added = "instance_added";
		const godot::StringName moved = "instance_moved";
		const godot::StringName data = "instance_data_changed";
	};

	SceneHost scene_host();
	std::vector<PlacedInstance> find_by_id(const char *p_method, int64_t p_id, bool even_removed);
	godot::Ref<ScatterRequest> request(Wanted wanted);
	void open_request(const Wanted &wanted);
	void give_up_requests();
	void renumber_requests(const ListedLayers &listed);

	void add_obstructions(
			const NavigationBake &bake, const Rect &ground, std::uint32_t layer, const SharedSnapshot &snapshot);
	std::vector<std::uint64_t> remove_all(std::span<const PlacedInstance> instances, double until = regrowth_of_layer);
	bool set_data(std::uint64_t id, bool exists, const godot::Variant &p_data);
	bool find_layer_to_add_to(const char *p_method, const godot::Variant &p_layer, std::uint32_t &r_layer);
	void claim_layers();
	Status claim(std::uint32_t layer);
	std::int64_t layer_index_of(std::uint64_t id) const;
	Rect area_of(std::uint64_t id, glm::dvec3 position, std::uint32_t layer) const;
	bool stands_no_longer(std::uint64_t id) const;
	void redraw_later(const StateChanges &changes);
	const PlacedInstance *find_changing(std::uint64_t id);
	void tell(const InstanceChange &change);
	void tell_backlog(std::chrono::steady_clock::time_point deadline);
	bool still_true(const InstanceChange &change) const;

	const Signals signals_;
	GameplayHost *host_; ///< Null once the node is freed.
	bool running_ = false;
	std::uint64_t run_ = 0;
	glm::dvec3 offset_{0.0}; ///< The world position of the engine's origin, in meters.
	std::vector<SharedSnapshot> layers_;
	SharedLayers listed_ = std::make_shared<const ListedLayers>(godot::TypedArray<ScatterLayer>());
	InstanceWorld world_;
	godot::Ref<ScatterState> state_;
	std::deque<Untold> backlog_;
	/// The instances that this node is removing or restoring and has not emitted signals for, in the order of the
	/// signals.
	std::span<const PlacedInstance> changing_;

	std::mutex wanted_mutex_;
	std::vector<Wanted> wanted_; ///< From other threads; guarded by `wanted_mutex_`.
	QueryRequests requests_;
	std::map<std::int64_t, Open> open_; ///< By their numbers in requests_.
	std::vector<Answered> answered_;

	CollisionRing collision_;
	SceneRing scenes_;
	std::array<NearRing *, 2> rings_{&collision_, &scenes_};
};

} // namespace thicket
