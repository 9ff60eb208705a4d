#pragma once

#include "core/drawing/lod_span.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// How the instances of one mesh are drawn in a cell, or in a tile that is drawn as a whole.
struct CellDrawing {
	LodSpan span;             ///< The wanted LODs.
	std::size_t lod = 0;      ///< The LOD that is drawn alone until all wanted LODs have a visual.
	float scale = 1.0F;       ///< The factor that makes up for thinned instances, as in compensating_scale.
	double thinned = 1.0;     ///< The share left by thinning with distance, 0 to 1.
	double density = 1.0;     ///< The share left by thinning, quality and the limit for all tiles, for any LOD: 0 to 1.
	std::size_t drawn = 0;    ///< The number of instances that the first of the LODs draws.
	std::uint64_t wanted = 0; ///< The number that it would draw without the limit for all tiles together.
};

/// Sets LODs, scale and thinning of a cell for its distance from the viewers. `steps` has one entry for each LOD, or none if no LOD of the
/// mesh fades; then one LOD is drawn at a time. The previous values of the cell determine the hysteresis.
void adapt(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		CellDrawing &r_cell);

/// How much the distances may change before `adapt` must be called again. Meters, 0 or more; infinite if nothing changes.
double adapted_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance);

/// The number of instances that a further LOD of a cell draws. `first_share` and `share` are the shares that the first
/// LOD and this LOD draw by their own settings, 0 to 1. If the limit for all tiles thins the first LOD, this LOD draws
/// no more instances than the first. Otherwise a cross-fade would show instances that are then removed. `ranks` are the
/// ranks of the cell's instances, ascending.
std::size_t drawn_by_other(
		std::span<const std::uint32_t> ranks, double first_share, double share, const CellDrawing &cell);

} // namespace thicket
