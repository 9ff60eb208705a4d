#pragma once

#include "core/drawing/lod.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

/// Limits for dividing the tiles of a layer into cells for drawing.
struct CellSettings {
	double tile_size = 64.0;       ///< Meters.
	std::uint32_t most_across = 1; ///< Cells along a side of a tile near a viewer; 1 if tiles are never divided.

	friend bool operator==(const CellSettings &, const CellSettings &) = default;
};

/// The number of cells along a side of a tile, 1 to max_cells_across, that brings their size closest to `cell_size`. Sizes are in meters.
/// Returns 1 for a cell size that is not smaller than the tile, is 0 or less, or is NAN.
std::uint32_t cells_across(double tile_size, double cell_size);

/// The default cell size, in meters, for a layer that sets none. `reach` is the distance in meters from a model's
/// origin to its farthest corner, and `density` is the number of instances of a model per square meter. The size is 32
/// m for a reach of 4 to 16 m, down to 24 m for smaller models, and twice the reach for larger ones. The size is larger
/// if a cell would otherwise contain fewer than `fewest_in_cell` instances.
double usual_cell_size(double reach, double density);
inline constexpr double fewest_in_cell = 16.0;

/// The number of cells along a side of a tile whose box is `distance` meters from the nearest viewer; 1 if the tile is drawn as a whole. A
/// tile is divided only where that changes the picture: where the meshes or the thinning change between its near and its far end. The
/// farther away they change, the larger a cell may be. Cells are as small as the settings allow, and double in size as long as they are
/// smaller than a quarter of the distance of the first such change.
///
/// `shown` is the current division, 0 for a tile that is not displayed. The current division is kept until the distance
/// is a tenth of the tile's size past the point of change. So a viewer who moves back and forth causes no uploads.
std::uint32_t division_at(const CellSettings &cells, const LodSettings &lod, double distance, std::uint32_t shown);

/// How much the distance may change, in either direction, before `division_at` must be called again. Meters, above 0; infinite where the
/// division is always 1. The new division may be late by an eighth of a tile.
double division_margin(const CellSettings &cells, const LodSettings &lod, double distance);

} // namespace thicket
