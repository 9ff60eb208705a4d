#pragma once

#include "core/drawing/lod.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

/// Settings for dividing the tiles of a layer into cells for drawing.
struct CellSettings {
	double tile_size = 64.0; ///< Width of a tile in meters.
	/// Maximum number of cells along an edge of a tile; 1 if tiles are never divided.
	std::uint32_t finest_division = 1;

	friend bool operator==(const CellSettings &, const CellSettings &) = default;
};

/// Returns the number of cells along an edge of a tile, 1 to max_cells_per_edge, for which a cell
/// has about the size `cell_size`. Sizes are in meters. The result is 1 for a cell size that is 0
/// or less, NAN, or not smaller than the tile.
std::uint32_t cell_count_per_edge(double tile_size, double cell_size);

/// Returns the default cell size in meters for a layer that does not set one. `reach` is the
/// distance in meters from a model's origin to its farthest corner, and `density` the number of
/// instances of a model per square meter. The size is 32 m for a reach of 4 to 16 m, down to 24 m
/// for smaller models, and twice the reach for larger ones. It is larger if a cell would otherwise
/// contain fewer than `min_instances_per_cell` instances.
double default_cell_size(double reach, double density);
inline constexpr double min_instances_per_cell = 16.0;

/// Returns the number of cells along an edge of a tile, or 1 if the tile is drawn as a whole.
/// `distance` is the distance in meters from the nearest viewer to the tile's box. A tile is
/// divided only if its mesh or thinning changes between its near and its far end. Cells grow with
/// the distance of the first such change. The smallest size that the settings allow is doubled
/// while it is less than a quarter of that distance.
///
/// `current_division` is 0 for a tile that is not displayed. The current division is kept until the
/// distance passes the point of change by a tenth of the tile size. A viewer that moves back and
/// forth therefore causes no uploads.
std::uint32_t division_at(
		const CellSettings &cells, const LodSettings &lod, double distance, std::uint32_t current_division);

/// Returns the distance in meters, above 0, by which a viewer may move before `division_at` must be
/// called again. The result is infinite if the division is always 1. A change in the division may
/// be delayed by up to an eighth of a tile.
double division_margin(const CellSettings &cells, const LodSettings &lod, double distance);

} // namespace thicket
