#pragma once

#include "core/placement/lod.hpp"

#include <cstddef>
#include <cstdint>

namespace thicket {

/// How finely the tiles of a layer may be divided for drawing.
struct CellSettings {
	double tile_size = 64.0;       ///< Meters.
	std::uint32_t most_across = 1; ///< Cells along a side of a tile near a viewer; 1 for tiles that are never divided.

	friend bool operator==(const CellSettings &, const CellSettings &) = default;
};

/// Into how many cells along its side a tile is divided so that they come nearest to a size, 1 to max_cells_across. Meters; 1 for a
/// size that is not below the tile's, or is 0 or less, or NAN.
std::uint32_t cells_across(double tile_size, double cell_size);

/// A size of cells, meters, for a layer that names none. `reach` is the meters from a model's origin to its farthest corner, and
/// `density` the instances of a model per square meter. 32 m for a reach of 4 to 16 m, down to 24 m for smaller models, twice the
/// reach for larger ones; more where a cell would hold fewer than `fewest_in_cell` instances.
double usual_cell_size(double reach, double density);
inline constexpr double fewest_in_cell = 16.0;

/// Into how many cells along its side a tile is divided whose box is `distance` meters from the nearest viewer; 1 for a tile that is
/// drawn as a whole. A tile is divided only where that changes the picture: where the meshes or the thinning change between its near
/// and its far end. The farther away they do, the larger a cell may be: cells are as small as the settings allow, and twice as large
/// whenever they would be smaller than a quarter of the distance of the first such change.
///
/// `shown` is how it is divided now, 0 for a tile that is not shown: that stays until the distance is a tenth of the tile's size
/// beyond where it should end, so that who walks to and fro sees nothing uploaded.
std::uint32_t division_at(const CellSettings &cells, const LodSettings &lod, double distance, std::uint32_t shown);

/// How much the distance may change, either way, before `division_at` is to be asked again. Meters, above 0; infinite where it is
/// always 1. An answer may come late by an eighth of a tile.
double division_margin(const CellSettings &cells, const LodSettings &lod, double distance);

} // namespace thicket
