#pragma once

#include "core/base/sight.hpp"
#include "core/base/view_volume.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace thicket {

/// Schedules visits to tiles, during which the caller updates a tile's LODs. A visit is due once a
/// viewer may have moved farther than the tile's margin. The schedule contains at most one visit
/// per tile. The class only makes decisions, like TileStreamer.
class LodSchedule {
public:
	/// Updates the viewers' positions for this frame. Returns true if their number has changed or
	/// one of them has jumped; every tile must then be visited.
	bool move(std::span<const Viewer> viewers);

	/// Schedules the next visit to a tile, after viewers have moved `margin` meters (0 or more).
	/// The new visit replaces one that is already scheduled. An infinite margin schedules no visit.
	/// Takes O(log tiles) time.
	void add(const TileKey &key, double margin);

	/// Removes the visit to a tile, if one is scheduled.
	void remove(const TileKey &key);

	/// Removes all visits.
	void clear();

	/// Removes the visit that is most overdue and returns its tile. Returns nothing if no visit is
	/// due.
	std::optional<TileKey> next();

	/// Returns true if `next` would return nothing.
	bool settled() const { return visits_.empty() || visits_.begin()->due_at > traveled_; }

	/// Returns the number of scheduled visits.
	std::size_t size() const { return visits_.size(); }

	/// Returns an upper bound for the accumulated movement of every viewer, in meters. Each `move`
	/// adds the largest distance that any viewer has moved.
	double traveled() const { return traveled_; }

	/// Returns the distances in meters from the nearest viewer to the nearest and the farthest
	/// point of a box. They are infinite if there are no viewers.
	DistanceRange distances_to(glm::dvec3 min, glm::dvec3 max, const Sight &sight) const;

private:
	struct Visit {
		double due_at = 0.0; ///< Value of `traveled_` at which the visit is due, in meters.
		TileKey key;
	};
	struct KeyOrder {
		bool operator()(const TileKey &a, const TileKey &b) const;
	};
	struct VisitOrder {
		bool operator()(const Visit &a, const Visit &b) const;
	};
	using Visits = std::set<Visit, VisitOrder>;

	std::vector<Viewer> viewers_;
	Visits visits_;                                             ///< All visits, the earliest first.
	std::map<TileKey, Visits::iterator, KeyOrder> tile_visits_; ///< Scheduled visit of each tile.
	double traveled_ = 0.0;                                     ///< The meters that traveled() returns.
};

} // namespace thicket
