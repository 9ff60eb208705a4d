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

/// What has to come and go around some centers, of all layers, in steps. Whoever takes an instance out of the queue makes or
/// frees what stands for it; the queue counts it as held, or not, from then on.
///
/// Distances are meters in space, from the nearest center to the instance's position. Everything within a layer's distance
/// comes; what is held leaves beyond `leave_share` of it. Where very much is near, only some cells are looked at in a frame: those that
/// have waited for more than `most_waiting` frames, then the nearest. Only what was found in the world as it is now comes and goes.
class NearQueue {
public:
	/// What a center may move, as a share of the distance, before anybody looks again.
	static constexpr double look_share = 0.025;
	static constexpr double enter_share = 1.0 + look_share;

	/// Apart from `enter_share`, so that nobody who walks to and fro makes something come and go.
	static constexpr double leave_share = 1.125;

	/// After so many instances no other cell is looked at in a frame: about a quarter of a millisecond.
	static constexpr std::size_t max_looked = 1024;

	static constexpr int most_waiting = 32;

	/// Nor a cell beyond those that have so much to do: more than a frame has time for.
	static constexpr std::size_t max_found = 256;

	/// The sides of so many cells reach as far as what is held: a look at one of them is a small part of a frame's work.
	static constexpr double cells_in_reach = 2.0;

	/// The distance of each layer, 0 for nothing. What is held of layers that are no more has to be released before.
	void set_distances(std::span<const double> distances);

	/// Finds out anew what has to come and go in cells for which a center has moved far enough, or the world has changed. To be
	/// called in every frame. The world is remembered until `forget_world`.
	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world);

	/// Takes out the nearest instance that is removed, or whose layer has no distance any more. False for none.
	bool next_gone(Leaving &r_leaving);

	/// Takes out an instance that is removed or too far away, of each cell first the removed ones, then the farthest. False for none.
	bool next_leaving(Leaving &r_leaving);

	/// Takes out an instance that is held in a different position, basis, mesh or layer. It stays held, as it is now. False for none.
	bool next_changed(PlacedInstance &r_instance);

	/// Takes out the nearest that is to come, which is held from then on. False for none.
	bool next_entering(PlacedInstance &r_instance);

	/// All that is held of a layer has to be rebuilt: `next_due` takes it out, whatever moves or changes meanwhile.
	void renew(std::uint32_t layer);

	/// Takes out the nearest instance that `renew` left to be rebuilt, as far as centers were at the last look. It stays held. It may come a
	/// second time after a change of its layer's distance. False for none.
	bool next_due(PlacedInstance &r_instance);

	/// The instances that are held within `reach` meters of one of these positions, in space: at most `most` of them, nearest first.
	std::vector<PlacedInstance> held_within(
			std::span<const glm::dvec3> positions, double reach, std::size_t most) const;

	/// The centers at the last look.
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// True if there is nothing to take out, and the world is as it was at the last look at every cell.
	bool settled() const;

	/// True if no center has moved far enough since `look_around` for anything else to come or go.
	bool follows(std::span<const glm::dvec3> centers) const;

	bool holds(std::uint32_t layer, std::uint64_t id) const;

	/// Counts an instance as not held, in all layers. Nothing comes out of the queue before the next look.
	void release(std::uint64_t id);

	/// The same for one layer; what else is to come and go still does.
	void release(std::uint32_t layer, std::uint64_t id);

	/// Holds nothing of a layer.
	void release_layer(std::uint32_t layer);
	void forget_world() { world_ = nullptr; }

private:
	using Key = std::pair<std::int64_t, std::int64_t>;

	struct Layer {
		double distance = 0.0;
		double side = 0.0; ///< Of a cell, meters.
		std::map<Key, NearCell> cells;
		bool stale = true;               ///< The cells that are near have to be found anew.
		std::vector<glm::dvec3> centers; ///< As of then.

		double slack() const { return look_share * distance; }
		Key key(glm::dvec3 position) const;
		Rect rect(const Key &key) const;
		bool divide(double new_side);
		void find_cells(std::span<const glm::dvec3> now);
	};

	/// A cell with instances that are due.
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
		bool due = false;                       ///< It can wait for those that are outdated.
		std::tuple<bool, bool, double> order{}; ///< Of looks.
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
	std::vector<Renewal> due_cells_; ///< A heap, the nearest on top.
	std::vector<Visit> outdated_;
	std::vector<std::pair<double, std::size_t>>
			busy_;             ///< Squared distances of fresh cells, and how much they have to do.
	std::vector<Visit> ready_; ///< Cells with something to take out, found in the world as it was at `look_around`.
	std::vector<PlacedInstance> standing_;
	std::uint64_t looks_ = 0;
	std::uint64_t changes_ = 1;
	std::size_t looked_ = 0; ///< Instances, in this frame.
};

/// Keeps something standing for every instance that is near: a body, a scene. Works in small steps under the budget of the frame,
/// which it shares with the uploads. One thread at a time.
class NearRing {
public:
	virtual ~NearRing() = default;

	/// Once a frame: where those are for whom it matters (world meters), and what the world is now. Cheap while nobody has moved and
	/// world.version() is the same.
	virtual void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) = 0;

	/// Lets one instance come or go. False if there is nothing to do.
	virtual bool step() = 0;

	/// True if `step` would find nothing to do.
	virtual bool settled() const = 0;

	/// True if `look_around` with these centers would find nothing else to do.
	bool follows(std::span<const glm::dvec3> centers) const { return queue_.follows(centers); }

	/// The instance is removed, or placed differently: what was made for it goes at once, whatever the budget.
	virtual void drop(std::uint64_t id) = 0;

	/// The same for all that are removed: for a few, as the budget does not count. Calls `gone` only for what was made.
	virtual void drop_if(const std::function<bool(std::uint64_t id)> &gone) = 0;

	/// Where the engine's origin is in the world, meters. What can be seen, and what is near a center, is moved along at once; the
	/// rest by `step`.
	virtual void set_world_offset(glm::dvec3 offset) = 0;

	/// Frees everything now.
	virtual void clear() = 0;

protected:
	NearRing() = default;
	NearRing(const NearRing &) = default;
	NearRing &operator=(const NearRing &) = default;

	NearQueue queue_;
};

} // namespace thicket
