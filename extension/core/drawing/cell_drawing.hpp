#pragma once

#include "core/drawing/lod_span.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// The drawing state of one mesh's instances in a cell, or in a tile that is drawn as a whole.
struct CellDrawing {
	LodSpan span;                    ///< LODs to draw.
	std::size_t lod = 0;             ///< LOD that is drawn alone until all LODs of `span` have a visual.
	float scale = 1.0F;              ///< Scale factor that compensates for thinning; see compensating_scale.
	double remaining_fraction = 1.0; ///< Fraction that remains after thinning by distance, 0 to 1.
	/// Fraction that remains in every LOD after thinning, quality and max_instances, 0 to 1.
	double density = 1.0;
	std::size_t drawn_count = 0;    ///< Number of instances that the first LOD draws.
	std::uint64_t wanted_count = 0; ///< Number of instances that the first LOD would draw without max_instances.
};

/// Updates a cell's LODs, scale and thinning for its distance from the viewers. `steps` has one
/// entry per LOD. If it is empty, no LOD of the mesh fades, and only one LOD is drawn at a time.
/// The cell's previous values provide the hysteresis.
void adapt(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		CellDrawing &r_cell);

/// Returns how far the distance may change, in meters, without affecting the result of `adapt`. The
/// value is at least 0, or infinity if the result never changes.
double adapted_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance);

/// Returns the number of instances that an additional LOD of a cell draws. `first_fraction` and
/// `fraction` are the fractions, 0 to 1, that the first LOD and this LOD draw according to their
/// settings. If max_instances thins the first LOD, this LOD draws no more instances than the first.
/// Otherwise, a cross-fade would show instances that are removed afterward. `ranks` are the ranks
/// of the cell's instances, ascending.
std::size_t drawn_by_extra_lod(
		std::span<const std::uint32_t> ranks, double first_fraction, double fraction, const CellDrawing &cell);

} // namespace thicket
