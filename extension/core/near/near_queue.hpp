#pragma once

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

/// The instances that must enter and leave around some centers, for all layers, in steps. A caller takes an instance
/// out of the queue and creates or frees its node or body. From then on the queue counts the instance as held, or as
/// not held.
///
/// Distances are meters in space, from the nearest center to the instance's position. Every instance within a layer's distance enters, and
/// held instances leave beyond `leave_share` of it. If very many are near, only some cells are checked in a frame: those that have waited
/// for more than `most_waiting` frames, then the nearest. Only results that are valid for the current world are taken out.
class NearQueue {
public:
	/// How far a center may move, as a share of the distance, before its cells are checked again.
	static constexpr double look_share = 0.025;
	static constexpr double enter_share = 1.0 + look_share;

	/// Larger than `enter_share`, so that moving back and forth makes no instance enter and leave.
	static constexpr double leave_share = 1.125;

	/// After this many instances no further cell is checked in a frame: about a quarter of a millisecond.
	static constexpr std::size_t max_looked = 1024;

	static constexpr int most_waiting = 32;

	/// No cell is checked if nearer cells have this many pending changes, which is more than a frame has time for.
	static constexpr std::size_t max_found = 256;

	/// The number of cell sides in the distance up to which instances are held. So the check of one cell is a small
	/// part of a frame's work.
	static constexpr double cells_in_reach = 2.0;

	/// Sets the distance of each layer, 0 for none. Before a layer is removed, its held instances must be released.
	void set_distances(std::span<const double> distances);

	/// Finds the instances that must enter and leave in cells where a center has moved far enough or the world has changed. Call it in
	/// every frame. The queue keeps a pointer to the world until `forget_world`.
	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world);

	/// Takes out the nearest instance that is removed, or whose layer has no distance any more. Returns false if there
	/// is none.
	bool next_gone(Leaving &r_leaving);

	/// Takes out an instance that is removed or too far away. Each cell returns the removed ones first, then the farthest. False if there
	/// is none.
	bool next_leaving(Leaving &r_leaving);

	/// Takes out a held instance whose position, basis, mesh or layer has changed. It stays held in its new state.
	/// Returns false if there is none.
	bool next_changed(PlacedInstance &r_instance);

	/// Takes out the nearest instance that must enter. It is held from then on. False if there is none.
	bool next_entering(PlacedInstance &r_instance);

	/// Marks all held instances of a layer to be rebuilt. `next_due` takes them out, whatever moves or changes in the
	/// meantime.
	void renew(std::uint32_t layer);

	/// Takes out the nearest instance that `renew` has marked, measured from the centers at the last check. It stays
	/// held. It may be returned a second time if its layer's distance changes. Returns false if there is none.
	bool next_due(PlacedInstance &r_instance);

	/// The instances that are held within `reach` meters of one of these positions, in space: at most `most` of them, nearest first.
	std::vector<PlacedInstance> held_within(
			std::span<const glm::dvec3> positions, double reach, std::size_t most) const;

	/// The centers at the last check.
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// True if there is nothing to take out, and the world has not changed since the last check of every cell.
	bool settled() const;

	/// True if no center has moved far enough since `look_around` for any other instance to enter or leave.
	bool follows(std::span<const glm::dvec3> centers) const;

	bool holds(std::uint32_t layer, std::uint64_t id) const;

	/// Counts an instance as not held, in all layers. The queue returns no instance before the next check.
	void release(std::uint64_t id);

	/// Counts an instance as not held in one layer. Other pending changes remain.
	void release(std::uint32_t layer, std::uint64_t id);

	/// Releases all instances of a layer.
	void release_layer(std::uint32_t layer);
	void forget_world() { world_ = nullptr; }

private:
	using Key = std::pair<std::int64_t, std::int64_t>;

	struct Layer {
		double distance = 0.0;
		double side = 0.0; ///< The side of a cell, in meters.
		std::map<Key, NearCell> cells;
		bool stale = true;               ///< True if the near cells must be determined again.
		std::vector<glm::dvec3> centers; ///< The centers at that time.

		double slack() const { return look_share * distance; }
		Key key(glm::dvec3 position) const;
		Rect rect(const Key &key) const;
		bool divide(double new_side);
		void find_cells(std::span<const glm::dvec3> now);
	};

	/// A cell with instances that must be rebuilt.
	struct Renewal {
		double away = 0.0; ///< The squared distance of the cell, or of the next instance once `listed`.
		std::uint32_t layer = 0;
		Key key;
		bool listed = false;
		std::vector<std::pair<double, PlacedInstance>> due; ///< By squared distances, nearest last.
	};

	struct Visit {
		std::uint32_t layer = 0;
		Key key;
		NearCell *cell = nullptr;
		bool due = false;                       ///< The check can wait until outdated cells are checked.
		std::tuple<bool, bool, double> order{}; ///< The order of the checks.
	};

	NearVersion version() const { return {world_->version(), changes_}; }
	void find_outdated(std::uint32_t layer);
	void look_at_nearest();
	void look(const Visit &visit);

	static bool farther(const Renewal &a, const Renewal &b) { return a.away > b.away; }
	void renew_divided(std::uint32_t layer);
	bool list_due(Renewal &r_renewal) const;
	std::span<const glm::dvec3> centers_of(const NearCell &cell) const;

	const InstanceWorld *world_ = nullptr;
	std::vector<glm::dvec3> centers_;
	std::vector<Layer> layers_;
	std::vector<Renewal> due_cells_; ///< A heap with the nearest on top.
	std::vector<Visit> outdated_;
	/// Squared distances of checked cells, and their number of pending changes.
	std::vector<std::pair<double, std::size_t>> busy_;
	/// Cells with something to take out, checked against the world as it was at `look_around`.
	std::vector<Visit> ready_;
	std::vector<PlacedInstance> standing_;
	std::uint64_t looks_ = 0;
	std::uint64_t changes_ = 1;
	std::size_t looked_ = 0; ///< Number of instances, in this frame.
};

/// Keeps a body or a scene for every instance near a center. Works in small steps within the budget of the frame, which
/// it shares with the uploads. One thread at a time.
class NearRing {
public:
	virtual ~NearRing() = default;

	/// Call it once per frame with the centers (world meters) and the current world. Cheap while no center has moved and world.version() is
	/// unchanged.
	virtual void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) = 0;

	/// Lets one instance enter or leave. False if there is nothing to do.
	virtual bool step() = 0;

	/// True if `step` would find nothing to do.
	virtual bool settled() const = 0;

	/// True if `look_around` with these centers would find nothing more to do.
	bool follows(std::span<const glm::dvec3> centers) const { return queue_.follows(centers); }

	/// Frees the body or scene of an instance immediately, regardless of the budget, because the instance is removed or
	/// placed differently.
	virtual void drop(std::uint64_t id) = 0;

	/// Like `drop`, for each instance for which `gone` returns true. Ignores the budget, so use it for a few instances.
	/// Calls `gone` only for instances that have a body or scene.
	virtual void drop_if(const std::function<bool(std::uint64_t id)> &gone) = 0;

	/// Sets the position of the engine's origin in the world, in meters. Objects that are visible or near a center are moved immediately,
	/// the rest by `step`.
	virtual void set_world_offset(glm::dvec3 offset) = 0;

	/// Frees everything immediately.
	virtual void clear() = 0;

protected:
	NearRing() = default;
	NearRing(const NearRing &) = default;
	NearRing &operator=(const NearRing &) = default;

	NearQueue queue_;
};

} // namespace thicket
