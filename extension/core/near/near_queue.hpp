#pragma once

#include "core/base/world_frame.hpp"
#include "core/near/near_cell.hpp"
#include "core/query/instance_world.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket {

/// A held instance near any of several positions; see NearQueue::held_within.
struct NearHeld {
	double distance_squared = 0.0; ///< Squared distance to the nearest position, in square meters.
	std::uint32_t layer = 0;
	std::uint64_t id = 0;
};

/// Determines, for all layers, which instances must enter and leave around a set of centers, such
/// as players. The caller takes one instance at a time from the queue and creates or frees its node
/// or body. After that, the queue considers the instance held or not held.
///
/// Distances are in meters, measured in space from the nearest center to the instance's position.
/// Every instance within a layer's distance enters, and held instances leave beyond `leave_factor`
/// times that distance. If very many instances are near, a frame checks only some of the cells.
/// Cells that have waited for more than `max_waiting_frames` frames come first, followed by the
/// nearest ones. The queue returns only results that are valid for the current world.
class NearQueue {
public:
	/// The fraction of a layer's distance that a center may move before its cells are checked
	/// again.
	static constexpr double slack_fraction = 0.025;
	static constexpr double enter_factor = 1.0 + slack_fraction;

	/// Held instances leave beyond this factor times the layer's distance. It is larger than
	/// `enter_factor`, so that moving back and forth does not make instances enter and leave
	/// repeatedly.
	static constexpr double leave_factor = 1.125;

	/// After checking this many instances, which takes about a quarter of a millisecond, a frame
	/// checks no more cells.
	static constexpr std::size_t max_checked_instances = 1024;

	static constexpr int max_waiting_frames = 32;

	/// A cell is not checked while nearer cells have this many pending changes, because a frame
	/// cannot process more.
	static constexpr std::size_t max_nearer_changes = 256;

	/// The distance at which instances leave, as a multiple of the cell size. Small cells keep the
	/// check of a single cell a small part of a frame's work.
	static constexpr double cells_in_reach = 2.0;

	/// Sets the distance of each layer in meters; 0 disables the layer. Before you remove a layer,
	/// release its held instances.
	void set_distances(std::span<const double> distances);

	/// Finds the instances that must enter and leave. It checks only cells in which the world has
	/// changed or whose centers have moved far enough. Call this function every frame. The queue
	/// keeps a pointer to the world until `forget_world` is called.
	void find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world);

	/// Takes the nearest instance that was removed or whose layer is disabled. Returns false if
	/// there is none.
	bool next_removed(InstanceToRelease &r_leaving);

	/// Takes an instance that was removed or is too far away. Each cell returns the removed
	/// instances first, then the farthest ones. Returns false if there is none.
	bool next_leaving(InstanceToRelease &r_leaving);

	/// Takes a held instance whose position, basis, mesh or layer has changed. The queue then holds
	/// it in its new state. Returns false if there is none.
	bool next_changed(PlacedInstance &r_instance);

	/// Takes the nearest instance that must enter and marks it as held. Returns false if there is
	/// none.
	bool next_entering(PlacedInstance &r_instance);

	/// Marks all held instances of a layer to be rebuilt. `next_due` returns them, regardless of
	/// movements and changes in between.
	void renew(std::uint32_t layer);

	/// Takes the nearest instance that `renew` has marked, measured from the centers at the last
	/// check. The instance stays held. If its layer's distance changes, the instance may be
	/// returned a second time. Returns false if there is none.
	bool next_due(PlacedInstance &r_instance);

	/// Returns the instances that are held within `reach` meters, in space, of any of the
	/// positions: at most `max_count` instances, nearest first.
	std::vector<NearHeld> held_within(std::span<const glm::dvec3> positions, double reach, std::size_t max_count) const;

	/// Returns the centers of the last `find_changes`.
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// Returns true if no changes are pending and the world has not changed since the last check of
	/// any cell.
	bool settled() const;

	/// Returns true if no center has moved far enough since `find_changes` to make any instance
	/// enter or leave.
	bool follows(std::span<const glm::dvec3> centers) const;

	bool holds(std::uint32_t layer, std::uint64_t id) const;

	/// Stops holding an instance, in all layers. Until the next `find_changes`, the queue returns
	/// no instances.
	void release(std::uint64_t id);

	/// Stops holding an instance in one layer. Other pending changes stay valid.
	void release(std::uint32_t layer, std::uint64_t id);

	/// Stops holding all instances of a layer.
	void release_layer(std::uint32_t layer);
	void forget_world() { world_ = nullptr; }

private:
	using Key = std::pair<std::int64_t, std::int64_t>;

	struct Layer {
		double distance = 0.0;
		double side = 0.0; ///< Edge length of a cell in meters.
		std::map<Key, NearCell> cells;
		bool stale = true;               ///< True if the near cells must be recomputed.
		std::vector<glm::dvec3> centers; ///< The centers at the last computation.

		double slack() const { return slack_fraction * distance; }
		Key key(glm::dvec3 position) const;
		Rect rect(const Key &key) const;
		bool divide(double new_side);
		void find_cells(std::span<const glm::dvec3> new_centers);
	};

	/// A cell with instances that must be rebuilt.
	struct Renewal {
		double away = 0.0; ///< Squared distance of the next instance if `listed`, otherwise of the cell.
		std::uint32_t layer = 0;
		Key key;
		bool listed = false;
		/// Instances to rebuild, sorted by squared distance, nearest last.
		std::vector<std::pair<double, PlacedInstance>> due;
	};

	struct Visit {
		std::uint32_t layer = 0;
		Key key;
		NearCell *cell = nullptr;
		bool due = false; ///< True if the cell is due but not outdated; outdated cells are checked first.
		/// Sort key: not outdated, not late, then distance or waiting time.
		std::tuple<bool, bool, double> order{};
	};

	NearVersion version() const { return {world_->version(), changes_}; }
	void find_outdated(std::uint32_t layer);
	void check_nearest();
	void check(const Visit &visit);

	static bool farther(const Renewal &a, const Renewal &b) { return a.away > b.away; }
	void renew_divided(std::uint32_t layer);
	bool list_due(Renewal &r_renewal) const;
	std::span<const glm::dvec3> centers_of(const NearCell &cell) const;

	const InstanceWorld *world_ = nullptr;
	std::vector<glm::dvec3> centers_;
	std::vector<Layer> layers_;
	std::vector<Renewal> due_cells_; ///< A heap with the nearest cell on top.
	std::vector<Visit> outdated_;
	/// The squared distance and the number of pending changes of each cell with a valid result.
	std::vector<std::pair<double, std::size_t>> busy_;
	/// Cells with pending changes that are valid for the world at the last `find_changes`.
	std::vector<Visit> ready_;
	std::vector<PlacedInstance> present_;
	std::uint64_t check_count_ = 0;
	std::uint64_t changes_ = 1;
	std::size_t checked_instances_ = 0; ///< Number of instances checked in this frame.
};

/// Keeps a body or a scene for every instance near a center. It works in small steps within the
/// frame's time budget, which it shares with the uploads. Use it on one thread only.
class NearRing {
public:
	virtual ~NearRing() = default;

	/// Finds instances that need a body or a scene, or no longer need one. Call this function once
	/// per frame with the centers (world meters) and the current world. It is cheap while no center
	/// moves and world.version() is unchanged.
	virtual void find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) = 0;

	/// Processes one instance. Returns false if there is nothing to do.
	virtual bool step() = 0;

	/// Returns true if `step` would have nothing to do.
	virtual bool settled() const = 0;

	/// Returns true if `find_changes` with these centers would find nothing new to do.
	bool follows(std::span<const glm::dvec3> centers) const { return queue_.follows(centers); }

	/// Frees the body or scene of an instance immediately, regardless of the time budget. Call this
	/// function when the instance is removed or moved.
	virtual void drop(std::uint64_t id) = 0;

	/// Calls `drop` for each instance for which `is_gone` returns true. This ignores the time
	/// budget, so use it only for a few instances. Only instances that have a body or scene are
	/// passed to `is_gone`.
	virtual void drop_if(const std::function<bool(std::uint64_t id)> &is_gone) = 0;

	/// Sets the world position of the engine's origin, in meters. Moves objects that are visible or
	/// near a center immediately; `step` moves the rest.
	virtual void set_world_frame(const WorldFrame &frame) = 0;

	/// Frees all bodies or scenes immediately.
	virtual void clear() = 0;

protected:
	NearRing() = default;
	NearRing(const NearRing &) = default;
	NearRing &operator=(const NearRing &) = default;

	NearQueue queue_;
};

} // namespace thicket
