#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/kept_tile.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::uint32_t max_cells_across = 16; ///< Cells along a side of a tile.

/// Some of the instances of one mesh in a tile: those that stand in one cell.
struct DrawCell {
	std::uint32_t number = 0; ///< Row by row: z times the cells along a side, plus x.
	std::uint32_t begin = 0;  ///< Its part of DrawCells::order.
	std::uint32_t end = 0;
	glm::vec3 min{
			0.0f}; ///< Smallest and largest position relative to the tile's origin, the size of the mesh not counted.
	glm::vec3 max{0.0f};

	std::size_t size() const { return end - begin; }
};

/// The instances of one mesh in a tile, divided into cells for drawing. Each of them is in one cell, and within a cell they keep
/// the tile's order, by (thinning rank, id): a prefix of a cell is the cell's share of a prefix of the tile.
struct DrawCells {
	std::vector<std::uint32_t> order; ///< Indices of the tile's instances, cell after cell.
	std::vector<std::uint32_t> ranks; ///< Of each of these; ascending within a cell.
	std::vector<DrawCell> cells;      ///< By number; those without instances are left out.

	bool empty() const { return cells.empty(); }

	/// Of memory, beside the object itself.
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
/// corners follow from the tile's rectangle alone, so they are those of a lattice that stands still in the world. What its layer
/// has moved out of the rectangle belongs to the nearest cell. O(instances + cells). Without the memory for it, `r_cells` is empty.
Status divide(const KeptMesh &mesh, glm::dvec3 origin, const Rect &rect, std::uint32_t across, DrawCells &r_cells);

/// Writes the floats of these instances of a mesh, one after the other. `r_buffer` has mesh.stride() for each of them.
void gather(const KeptMesh &mesh, std::span<const std::uint32_t> order, std::span<float> r_buffer);

/// The way back: puts the floats of a cell where they were in the tile. `r_buffer` has room for all instances of the tile.
void spread(std::span<const float> buffer, std::span<const std::uint32_t> order, std::size_t stride,
		std::span<float> r_buffer);

/// True if the same instances, to the bit, stand in two cells in the same order.
bool same_instances(const KeptMesh &a, std::span<const std::uint32_t> order_a, const KeptMesh &b,
		std::span<const std::uint32_t> order_b);

} // namespace thicket
