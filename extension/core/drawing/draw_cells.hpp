#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::uint32_t max_cells_across = 16; ///< Cells along a side of a tile.

/// The instances of one mesh in a tile that are placed in one cell.
struct DrawCell {
	std::uint32_t number = 0; ///< Row by row: z times the cells along a side, plus x.
	std::uint32_t begin = 0;  ///< The cell's part of DrawCells::order.
	std::uint32_t end = 0;
	/// The smallest and the largest position relative to the tile's origin, without the size of the mesh.
	glm::vec3 min{0.0f};
	glm::vec3 max{0.0f};

	std::size_t size() const { return end - begin; }
};

/// The instances of one mesh in a tile, divided into cells for drawing. Each instance is in exactly one cell. Within a cell, instances keep
/// the tile's order, by (thinning rank, id): a prefix of a cell is the cell's share of a prefix of the tile.
struct DrawCells {
	std::vector<std::uint32_t> order; ///< Indices of the tile's instances, one cell after the other.
	std::vector<std::uint32_t> ranks; ///< The rank of each of these; ascending within a cell.
	std::vector<DrawCell> cells;      ///< By number; cells without instances are left out.

	bool empty() const { return cells.empty(); }

	/// Bytes of memory, without the object itself.
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

/// Divides a tile's instances of one mesh into `across` by `across` cells, 1 to max_cells_across. The cells are half-open squares whose
/// corners follow from the tile's rectangle alone, so they form a lattice that is fixed in the world. Instances that their layer has moved
/// out of the rectangle belong to the nearest cell. O(instances + cells). If memory runs out, `r_cells` is empty.
Status divide(const CompactMesh &mesh, glm::dvec3 origin, const Rect &rect, std::uint32_t across, DrawCells &r_cells);

/// Writes the floats of these instances of a mesh, one after the other. `r_buffer` has room for mesh.stride() floats
/// per instance.
void gather(const CompactMesh &mesh, std::span<const std::uint32_t> order, std::span<float> r_buffer);

/// The reverse of `gather`: writes the floats of a cell back to their positions in the tile. `r_buffer` has room for
/// all instances of the tile.
void spread(std::span<const float> buffer, std::span<const std::uint32_t> order, std::size_t stride,
		std::span<float> r_buffer);

/// The source of a cell's visuals after the tile's instances have changed.
struct CellReuse {
	std::optional<std::size_t> before; ///< The former cell at the same position, by index; none for a new cell.
	bool unchanged = false;            ///< The cell has bit-identical instances in the same order.
};

/// The sources of all cells of `cells`, for two divisions of the same tile into equally many cells along a side.
/// O(instances + cells).
std::vector<CellReuse> reuse_cells(
		const CompactMesh &mesh_before, const DrawCells &cells_before, const CompactMesh &mesh, const DrawCells &cells);

} // namespace thicket
