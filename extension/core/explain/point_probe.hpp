#pragma once

#include "core/placement/tile_filter.hpp"
#include "core/sampling/nearest_points.hpp"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Finds the points of a layer's set that are nearest to positions, before the layer's own rules
/// apply. The points of a layer that fills gaps depend on the instances of its neighbors, and so on
/// the ground. The work therefore has steps, as for TileBuilder: call `find`, then `find_further` with
/// the ground at positions() until is_complete() is true, then read points().
class PointProbe {
public:
	/// Begins a search. The layer must be valid and must not be on surfaces. The positions (world
	/// meters) should be close together. Returns the errors of nearest_points and TileBuilder.
	Status find(const LayerSettings &layer, std::span<const glm::dvec2> positions);

	/// Discards the last search.
	void clear() { fills_ = false; }

	bool is_complete() const { return !fills_ || filter_.is_complete(); }
	Status find_further(std::span<const Ground> ground);

	/// These functions return the positions at which `find_further` needs the ground, and the
	/// queries for these positions.
	std::span<const glm::dvec2> positions() const { return positions_; }
	std::span<const GroundQuery> queries() const { return queries_; }

	/// Returns the nearest point for each position. If no point is nearer than the radius, which
	/// only happens for a layer that fills gaps or is in rows, the entry is no_point.
	std::span<const SamplePoint> points() const { return points_; }

private:
	Status find_in_rows(const LayerSettings &layer, std::span<const glm::dvec2> positions);
	Status gather();

	bool fills_ = false;
	TileSampler sampler_;
	TileFilter filter_{SampleMargins()};
	PointSet set_;
	std::vector<glm::dvec2> targets_;
	std::vector<glm::dvec2> positions_;
	std::vector<GroundQuery> queries_;
	std::vector<SamplePoint> points_;
};

} // namespace thicket
