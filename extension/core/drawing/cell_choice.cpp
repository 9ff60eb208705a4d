#include "core/drawing/cell_choice.hpp"

#include "core/drawing/draw_cells.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

namespace thicket {

namespace {

/// Smallest cell size, as a fraction of the distance of a change.
constexpr double cell_size_per_distance = 0.25;
/// Distance past the point of change at which the division actually changes, in tile sizes.
constexpr double hysteresis = 0.1;
constexpr double min_division_margin = 0.125; ///< Minimum result of division_margin, in tile sizes.

/// Returns the first distance in a range at which the mesh or the thinning changes, in meters, or
/// infinity if there is none.
double first_change(const LodSettings &lod, double near, double far) {
	double first = std::numeric_limits<double>::infinity();
	for (const double begin : lod.lod_distances) {
		if (near < begin && lod_hysteresis * begin < far) {
			first = std::min(first, begin);
		}
	}
	if (lod.thin_density < 1.0 && near < lod.thin_end && lod.thin_begin < far) {
		first = std::min(first, std::max(near, lod.thin_begin));
	}
	return first;
}

/// Returns the division for a distance, without hysteresis.
std::uint32_t division_for(const CellSettings &cells, const LodSettings &lod, double distance) {
	const double size = cells.tile_size;
	const double min_cell_size =
			cell_size_per_distance * first_change(lod, distance, distance + std::numbers::sqrt2 * size);
	std::uint32_t cells_per_edge = cells.finest_division;
	while (cells_per_edge > 1 && size / cells_per_edge < min_cell_size) {
		cells_per_edge /= 2;
	}
	return cells_per_edge;
}

} // namespace

std::uint32_t cell_count_per_edge(double tile_size, double cell_size) {
	if (!(cell_size > 0.0)) {
		return 1;
	}
	const double cells = std::floor(tile_size / cell_size + 0.5);
	return static_cast<std::uint32_t>(std::clamp(cells, 1.0, static_cast<double>(max_cells_per_edge)));
}

double default_cell_size(double reach, double density) {
	const double model_cell_size = std::max(std::clamp(8.0 * reach, 24.0, 32.0), 2.0 * reach);
	return density > 0.0 ? std::max(model_cell_size, std::sqrt(min_instances_per_cell / density)) : model_cell_size;
}

std::uint32_t division_at(
		const CellSettings &cells, const LodSettings &lod, double distance, std::uint32_t current_division) {
	if (cells.finest_division < 2) {
		// Tiles of this layer are never divided.
		return 1;
	}
	const double margin = hysteresis * cells.tile_size;
	for (const double shifted_distance : {distance - margin, distance + margin}) {
		if (current_division > 0 && division_for(cells, lod, std::max(shifted_distance, 0.0)) == current_division) {
			return current_division;
		}
	}
	return division_for(cells, lod, distance);
}

double division_margin(const CellSettings &cells, const LodSettings &lod, double distance) {
	const bool thins = lod.thin_density < 1.0;
	if (cells.finest_division < 2 || (lod.lod_distances.empty() && !thins)) {
		return std::numeric_limits<double>::infinity();
	}
	// Tiles are drawn as a whole beyond the smaller of two distances. Beyond the first distance,
	// even the largest cell (half a tile) is smaller than necessary. Beyond the second, neither the
	// mesh nor the thinning changes.
	const double small_cell_distance = 0.5 / cell_size_per_distance * cells.tile_size;
	const double last_change =
			std::max(lod.lod_distances.empty() ? 0.0 : lod.lod_distances.back(), thins ? lod.thin_end : 0.0);
	const double farthest = std::min(small_cell_distance, last_change) + hysteresis * cells.tile_size;
	return std::max(distance - farthest, min_division_margin * cells.tile_size);
}

} // namespace thicket
