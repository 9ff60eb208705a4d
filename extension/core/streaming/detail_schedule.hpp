#pragma once

#include "core/streaming/tile_streamer.hpp"

#include <glm/vec3.hpp>

#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// Says which tiles to look at again as viewers move: each only after a viewer has moved as far as that tile allows. Pure
/// logic, like TileStreamer.
class DetailSchedule {
public:
	/// A visit to a tile that is to come, when viewers have moved so far in all.
	struct Visit {
		double at = 0.0; ///< Meters, as `traveled` counts them.
		TileKey key;
	};

	/// Takes the viewers' places for this frame. True if there are others than before: every tile has to be looked at then,
	/// whatever was scheduled.
	bool move(std::span<const Viewer> viewers);

	/// Schedules the next visit to a tile: after `margin` meters, 0 or more; none for an infinite margin. Returns the `at` of
	/// that look: only the look that a tile was scheduled for last is of any use, others are to be ignored.
	double add(const TileKey &key, double margin);

	/// A visit that is due, taken out; nothing if none is.
	std::optional<Visit> next();

	/// True if there is nothing to take out by `next`.
	bool settled() const { return visits_.empty() || visits_.front().at > traveled_; }

	/// Forgets all visits.
	void clear() { visits_.clear(); }

	/// From the nearest viewer to a box. Meters, infinite without viewers.
	double distance_to(glm::dvec3 min, glm::dvec3 max) const;

private:
	std::vector<Viewer> viewers_;
	std::vector<Visit> visits_; ///< A heap, the next on top.
	double traveled_ = 0.0; ///< By the farthest-moving viewer of each frame, summed up: no viewer has moved farther.
};

} // namespace thicket
