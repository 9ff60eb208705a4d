#pragma once

#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/placement/compact_tile.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::uint32_t max_cells_per_edge = 16; ///< Maximum number of cells along an edge of a tile.

/// The two world axes along which a tile is divided: 0 is x, 1 is y and 2 is z.
struct CellAxes {
	int column = 0;
	int row = 2;

	friend bool operator==(const CellAxes &, const CellAxes &) = default;
};

/// Returns the axes for a tile. The cubic tiles of planets are divided along the two axes that are
/// nearest to the ground, so that their cells are not slices of it. All other tiles are divided along
/// x and z.
CellAxes cell_axes(const TileSpace &space, const Planet &planet);

/// A cell: the instances of one mesh in a square part of a tile.
struct DrawCell {
	std::uint32_t index = 0; ///< Row by row: row * (cells along an edge) + column.
	std::uint32_t begin = 0; ///< The cell's range in DrawCells::order; `end` is exclusive.
	std::uint32_t end = 0;
	/// Bounds of the instances' positions relative to the tile's origin, without the extent of the
	/// mesh.
	glm::vec3 min{0.0f};
	glm::vec3 max{0.0f};

	std::size_t size() const { return end - begin; }
};

/// The instances of one mesh in a tile, divided into cells for drawing. Each instance is in exactly
/// one cell. Within a cell, instances keep the tile's order by (thinning rank, ID). Thinning draws
/// the first instances of this order, both for a whole tile and for each cell.
struct DrawCells {
	std::vector<std::uint32_t> order; ///< Indices of the tile's instances, grouped by cell.
	std::vector<std::uint32_t> ranks; ///< The instances' thinning ranks in the same order; ascending within a cell.
	std::vector<DrawCell> cells;      ///< Cells with at least one instance, ascending by index.

	bool empty() const { return cells.empty(); }

	/// Returns the memory in bytes that the members use, without this object itself.
	std::size_t bytes() const {
		return (order.capacity() + ranks.capacity()) * sizeof(std::uint32_t) + cells.capacity() * sizeof(DrawCell);
	}
	std::span<const std::uint32_t> order_of(const DrawCell &cell) const {
		return std::span(order).subspan(cell.begin, cell.size());
	}
	std::span<const std::uint32_t> ranks_of(const DrawCell &cell) const {
		return std::span(ranks).subspan(cell.begin, cell.size());
	}
};

/// Divides a tile's instances of one mesh into a square of cells, `cells_per_edge` along each edge,
/// clamped to the range from 1 to max_cells_per_edge. The cells are half-open squares that depend
/// only on the tile's space, so they form a fixed lattice in the world. An instance that its
/// layer's offset moves outside the space belongs to the nearest cell. `space` must be bounded
/// along `axes`. Takes O(instances + cells) time. If memory runs out, `r_cells` is empty.
Status divide(const CompactMesh &mesh, glm::dvec3 origin, const TileSpace &space, std::uint32_t cells_per_edge,
		DrawCells &r_cells, const CellAxes &axes = {});

/// Writes the floats of the instances at the indices `order`, in this order. `r_buffer` must have
/// mesh.stride() floats per index.
void gather(const CompactMesh &mesh, std::span<const std::uint32_t> order, std::span<float> r_buffer);

/// The inverse of `gather`: writes the floats of a cell to their positions in the tile's buffer.
/// `r_buffer` must have `stride` floats for each instance of the tile.
void spread(std::span<const float> buffer, std::span<const std::uint32_t> order, std::size_t stride,
		std::span<float> r_buffer);

/// The old cell whose visuals a new cell can reuse after the tile's instances have changed.
struct CellReuse {
	/// Position in the old list of the cell with the same index; none if there was no such cell.
	std::optional<std::size_t> old_cell;
	bool is_unchanged = false; ///< True if both cells have bit-identical instances in the same order.
};

/// Finds the reusable old cell for each cell in `cells`. Both divisions must belong to the same
/// tile and have the same number of cells along an edge. Takes O(instances + cells) time.
std::vector<CellReuse> reuse_cells(
		const CompactMesh &old_mesh, const DrawCells &old_cells, const CompactMesh &mesh, const DrawCells &cells);

} // namespace thicket
