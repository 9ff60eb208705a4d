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

/// Schedules which tiles to check again as viewers move: each tile only after a viewer has moved as far as that tile
/// allows. Pure logic, like TileStreamer. Stores at most one visit per tile.
class LodSchedule {
public:
	/// Takes the viewers' positions for this frame. Returns true if their number has changed or one of them has jumped. Every tile must
	/// then be checked, whatever was scheduled.
	bool move(std::span<const Viewer> viewers);

	/// Schedules the next visit to a tile, after `margin` meters (0 or more). Replaces the tile's earlier visit. With
	/// an infinite margin, schedules no visit. O(log tiles).
	void add(const TileKey &key, double margin);

	/// Removes the visit to a tile that is gone.
	void remove(const TileKey &key);

	/// Removes all visits.
	void clear();

	/// Removes the most overdue visit and returns its tile. Returns nothing if no visit is due.
	std::optional<TileKey> next();

	/// True if `next` would return nothing.
	bool settled() const { return visits_.empty() || visits_.begin()->at > traveled_; }

	/// The number of scheduled visits.
	std::size_t size() const { return visits_.size(); }

	/// Meters, accumulated over all calls. Between two calls of `move`, no viewer has moved farther than this value has
	/// grown.
	double traveled() const { return traveled_; }

	/// The distances from a box to the viewer nearest to it: from the nearest and from the farthest point of the box.
	/// Meters; infinite without viewers.
	DistanceRange distances_to(glm::dvec3 min, glm::dvec3 max, const Sight &sight) const;

private:
	struct Visit {
		double at = 0.0; ///< Value of `traveled_` at which the visit is due, in meters.
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
	Visits visits_;                                         ///< The next one first.
	std::map<TileKey, Visits::iterator, KeyOrder> by_tile_; ///< The visit of each tile that has one.
	double traveled_ = 0.0; ///< Sum over frames of the farthest viewer movement. An upper bound for each viewer.
};

} // namespace thicket
