#pragma once

#include "core/query/instance_world.hpp"
#include "core/query/query_requests.hpp"
#include "nodes/gameplay/collision_ring.hpp"
#include "nodes/gameplay/scatter_instances.hpp"
#include "nodes/gameplay/scatter_request.hpp"
#include "nodes/gameplay/scatter_snapshot.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/scene_ring.hpp"
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
#include <utility>
#include <variant>
#include <vector>

namespace thicket {

/// What a ScatterGameplay needs of the node that it works for.
class GameplayHost {
public:
	/// The parent of scenes, and who emits the signals.
	virtual godot::Node3D *node() = 0;
	virtual godot::TypedArray<ScatterLayer> layers() const = 0;

	/// Settings that were changed in this frame count from now on. Refused where there is nothing to ask. May run scripts.
	virtual Status prepare() = 0;

	/// Generates tiles on any thread, several at once, from what the layers and the ground are now. For after `prepare`.
	virtual TileMaker make_worker_maker() = 0;

	/// What lies over the picture from now on; null for nothing.
	virtual void set_overlay(const InstanceState *state) = 0;

	/// The picture of a layer has changed in an area: it follows before this frame is drawn.
	virtual void redraw(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all() = 0;

	/// The same over the next frames, under their budget.
	virtual void redraw_later(std::uint32_t layer, const Rect &area) = 0;
	virtual void redraw_all_later() = 0;

	/// Lets go of something large on another thread.
	virtual void let_go(std::shared_ptr<const void> unneeded) = 0;
	virtual void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) = 0;

	/// Calls ScatterGameplay::recycle_scenes before this frame is drawn and before bodies move again.
	virtual void recycle_soon() = 0;

protected:
	GameplayHost() = default;
	~GameplayHost() = default;
	GameplayHost(const GameplayHost &) = default;
	GameplayHost &operator=(const GameplayHost &) = default;
};

struct NavigationBake;

/// What a game asks of a TerrainScatter3D and changes about it, and the bodies and scenes that stand near by. Main thread only.
///
/// Scripts run in the middle of much of it: predicates, terrains, handlers of signals, scenes. They may do anything. So whoever
/// calls this object holds it by a shared pointer of its own, and after every call that runs scripts it is asked what they have
/// left: the node may be gone (`alive`) or out of the tree (`run`), and layers, state and tiles may be others.
class ScatterGameplay final : public StateListener, public std::enable_shared_from_this<ScatterGameplay> {
public:
	explicit ScatterGameplay(GameplayHost &host);
	~ScatterGameplay() override;

	// The node.

	/// The node goes. Nothing of it is touched from now on.
	void detach();
	bool alive() const { return host_ != nullptr; }

	/// The node is in a world, in which bodies stand in `space` (invalid for none).
	void start(const godot::RID &space, std::uint64_t node_id);

	/// The node is out of it.
	void stop();

	/// Another number whenever the node has come or gone.
	std::uint64_t run() const { return run_; }

	/// Nothing stands any more: bodies and scenes go, tiles are forgotten, requests complete without an answer.
	void clear();

	/// The same for a node that goes on without layers or ground: bodies and scenes leave step by step, the nearest first.
	void retire();
	void set_layers(const std::vector<SharedSnapshot> &layers, std::span<const EditedArea> outdated, TileMaker maker);
	void set_world_offset(glm::dvec3 offset);
	glm::dvec3 world_offset() const { return offset_; }
	InstanceWorld &world() { return world_; }
	CollisionRing &collision() { return collision_; }
	SceneRing &scenes() { return scenes_; }
	const CollisionRing &collision() const { return collision_; }
	const SceneRing &scenes() const { return scenes_; }

	// The frame.

	/// Moves the state's clock on. Runs scripts.
	void advance(double seconds, std::uint64_t frame);

	/// Around these world positions bodies and scenes stand.
	void look_around(std::span<const glm::dvec3> centers);

	/// Takes in what other threads have requested and canceled since the last frame. Runs scripts.
	void take_requests();

	/// Answers the requests whose tiles are there. Runs no scripts.
	void answer_requests();

	/// Applies their predicates to the answers and emits their signals. Runs scripts.
	void complete_requests();

	/// Scenes come and go, and what was changed in large numbers is told, until `deadline`; a step of each in any case. Runs scripts.
	void work_until(std::chrono::steady_clock::time_point deadline);
	void recycle_scenes();

	/// True if neither bodies and scenes nor signals have to follow any more.
	bool settled() const { return collision_.settled() && scenes_.settled() && backlog_.empty(); }

	/// True if `look_around` would find nothing else to do for these positions.
	bool follows(std::span<const glm::dvec3> centers) const;

	// As script_queries.hpp needs them.

	/// Asks what is known, and has made for it what is not. Holds the state meanwhile.
	bool ask(const char *p_method, const AskedQuery &query);
	bool find_filter(const char *p_method, const godot::Variant &p_layers, const godot::Callable &p_predicate,
			QueryFilter &r_filter) const;

	// Questions. `p_layers` are layer references, none for all; a predicate takes (id, layer, transform) and says whether
	// that instance counts. What is refused prints an error, and the answer is empty.

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

	/// The world as it is now, for queries on other threads. Empty, with an error, where there is nothing to ask.
	godot::Ref<ScatterSnapshot> make_snapshot();

	/// On any thread, while the node is there. What another thread requests waits for `take_requests`, which prints the errors, too.
	godot::Ref<ScatterRequest> request_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate);
	godot::Ref<ScatterRequest> request_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);

	/// Adds to the source geometry of a navigation mesh what stands in the box that is baked, of the layers that affect navigation.
	/// Runs scripts.
	void add_obstructions(const NavigationBake &bake);

	// Changes. False, or 0, for what does not stand, stands already, or is refused.

	void set_state(const godot::Ref<ScatterState> &p_state);
	godot::Ref<ScatterState> get_state() const { return state_; }

	/// Refuses a state whose ids mean other points.
	Status check_state(const ScatterState &state) const;
	bool remove_instance(int64_t p_id);
	bool restore_instance(int64_t p_id);
	godot::PackedInt64Array remove_in_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate);
	int64_t add_instance(const godot::Variant &p_layer, const godot::Transform3D &p_transform, int64_t p_mesh);

	/// Many of them, 12 floats each as in the buffer of a MultiMesh; a mesh for each, or none for the first. All, or none.
	godot::PackedInt64Array add_instances(const godot::Variant &p_layer, const godot::PackedFloat32Array &p_transforms,
			const godot::PackedInt32Array &p_meshes);
	godot::PackedInt64Array remove_instances(const godot::PackedInt64Array &p_ids);
	int64_t set_instance_transform(int64_t p_id, const godot::Transform3D &p_transform);
	bool set_instance_data(int64_t p_id, const godot::Variant &p_data);
	godot::Variant get_instance_data(int64_t p_id) const;

	void state_changed(const SharedChanges &changes) override;
	void tell_changes(const SharedChanges &changes) override;

	/// What changes more instances than this at once is told, drawn and followed by scenes over the next frames.
	static constexpr std::size_t most_at_once = 1024;

	/// Of so many instances that a call removes or moves, bodies and scenes are gone when it returns.
	static constexpr std::size_t most_dropped_at_once = 128;

private:
	/// Of the engine's space, not yet the world's.
	struct SphereInScene {
		godot::Vector3 center;
		double radius = 0.0;
	};

	/// A request as it was made, on any thread.
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

	/// Changes that are being told over some frames.
	struct Untold {
		SharedChanges changes;
		std::size_t told = 0;
	};

	/// Of the node, by what they tell of. They are kept, as making a name costs as much as a removal.
	struct Signals {
		const godot::StringName &of(InstanceChangeKind kind) const;

		const godot::StringName none; ///< Nobody is told.
		const godot::StringName removed = "instance_removed";
		const godot::StringName restored = "instance_restored";
		const godot::StringName added = "instance_added";
		const godot::StringName moved = "instance_moved";
		const godot::StringName data = "instance_data_changed";
	};

	SceneHost scene_host();
	bool prepare(const char *p_method);
	std::vector<PlacedInstance> find_by_id(const char *p_method, int64_t p_id, bool even_removed);
	godot::Ref<ScatterRequest> request(Wanted wanted);
	void open_request(const Wanted &wanted);
	void give_up_requests();

	void add_obstructions(
			const NavigationBake &bake, const Rect &ground, std::uint32_t layer, const SharedSnapshot &snapshot);
	std::vector<std::uint64_t> remove_all(std::span<const PlacedInstance> instances);
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
	GameplayHost *host_; ///< Null once the node is gone.
	bool running_ = false;
	std::uint64_t run_ = 0;
	glm::dvec3 offset_{0.0}; ///< Of the engine's origin in the world, meters.
	std::vector<SharedSnapshot> layers_;
	InstanceWorld world_;
	godot::Ref<ScatterState> state_;
	std::deque<Untold> backlog_;
	/// What this node is removing or restoring and has not told yet, in the order of telling.
	std::span<const PlacedInstance> changing_;

	std::mutex wanted_mutex_;
	std::vector<Wanted> wanted_; ///< By other threads; guarded by `wanted_mutex_`.
	QueryRequests requests_;
	std::map<std::int64_t, Open> open_; ///< By their numbers in requests_.
	std::vector<std::pair<Open, FoundInstances>> answered_;

	CollisionRing collision_;
	SceneRing scenes_;
	std::array<NearRing *, 2> rings_{&collision_, &scenes_};
};

} // namespace thicket
