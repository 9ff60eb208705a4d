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

/// Says which tiles to look at again as viewers move: each only after a viewer has moved as far as that tile allows. Pure
/// logic, like TileStreamer. Holds one visit for each tile at most.
class LodSchedule {
public:
	/// Takes the viewers' positions for this frame. True if there are others than before: every tile has to be looked at
	/// then, whatever was scheduled.
	bool move(std::span<const Viewer> viewers);

	/// Schedules the next visit to a tile, in place of the one that was scheduled before: after `margin` meters, 0 or more;
	/// none for an infinite margin. O(log tiles).
	void add(const TileKey &key, double margin);

	/// Forgets the visit to a tile that is gone.
	void remove(const TileKey &key);

	/// Forgets all visits.
	void clear();

	/// A tile whose visit is due, the longest due first; the visit is taken out. Nothing if none is due.
	std::optional<TileKey> next();

	/// True if there is nothing to take out by `next`.
	bool settled() const { return visits_.empty() || visits_.begin()->at > traveled_; }

	/// How many visits are to come.
	std::size_t size() const { return visits_.size(); }

	/// Meters that count as gone by the viewers so far: no viewer has moved farther between two calls than this has grown.
	double traveled() const { return traveled_; }

	/// From the viewer that is nearest to a box to the nearest and to the farthest point of it. Meters, infinite without viewers.
	DistanceRange distances_to(glm::dvec3 min, glm::dvec3 max, const Sight &sight) const;

private:
	struct Visit {
		double at = 0.0; ///< Meters, as `traveled_` counts them.
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
	double traveled_ = 0.0; ///< By the farthest-moving viewer of each frame, summed up: no viewer has moved farther.
};

} // namespace thicket
