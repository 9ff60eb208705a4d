#include "core/drawing/draw_cells.hpp"

#include "core/base/guard.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Returns the index along one axis of the cell that contains a position. `edge` is the tile's
/// lower edge.
std::uint32_t cell_along(double position, double edge, double cell_size, std::uint32_t cells_per_edge) {
	double cell = std::floor((position - edge) / cell_size);
	// Rounding may move a position just below a cell's edge onto the edge. This line corrects it.
	cell -= position < edge + cell * cell_size ? 1.0 : 0.0;
	return static_cast<std::uint32_t>(std::clamp(cell, 0.0, static_cast<double>(cells_per_edge - 1)));
}

/// A square lattice of cells in a tile.
struct Lattice {
	glm::dvec3 edge; ///< The lower corner of the tile, relative to its origin.
	glm::dvec3 cell_size;
	std::uint32_t cells_per_edge;
	CellAxes axes;

	Lattice(const TileSpace &space, const glm::dvec3 &origin, std::uint32_t p_cells_per_edge, const CellAxes &p_axes) :
			edge(glm::dvec3(space.min.x, space.bottom, space.min.y) - origin),
			cell_size(glm::dvec3(space.size().x, space.top - space.bottom, space.size().y) /
					static_cast<double>(p_cells_per_edge)),
			cells_per_edge(p_cells_per_edge), axes(p_axes) {}

	std::uint32_t index_along(const glm::vec3 &position, int axis) const {
		return cell_along(double{position[axis]}, edge[axis], cell_size[axis], cells_per_edge);
	}

	std::uint16_t cell_index(const glm::vec3 &position) const {
		return static_cast<std::uint16_t>(
				index_along(position, axes.row) * cells_per_edge + index_along(position, axes.column));
	}
};

/// Returns the cell index of each instance. All functions below may throw std::bad_alloc.
std::vector<std::uint16_t> cell_indices(const CompactMesh &mesh, const Lattice &lattice) {
	std::vector<std::uint16_t> indices(mesh.size());
	std::ranges::transform(mesh.positions(), indices.begin(),
			[&lattice](const glm::vec3 &position) { return lattice.cell_index(position); });
	return indices;
}

void measure(const CompactMesh &mesh, std::span<const std::uint32_t> order, DrawCell &r_cell) {
	for (const std::uint32_t i : order) {
		const glm::vec3 &position = mesh.positions()[i];
		r_cell.min = i == order.front() ? position : glm::min(r_cell.min, position);
		r_cell.max = i == order.front() ? position : glm::max(r_cell.max, position);
	}
}

void add_cells(const CompactMesh &mesh, const Lattice &lattice, DrawCells &r_cells) {
	const std::uint32_t cells_per_edge = lattice.cells_per_edge;
	const std::vector<std::uint16_t> indices = cell_indices(mesh, lattice);
	// The cells are filled by a counting sort. First, cell_ends[index + 1] counts the instances of
	// a cell.
	std::vector<std::uint32_t> cell_ends(std::size_t{cells_per_edge} * cells_per_edge + 1);
	for (const std::uint16_t index : indices) {
		++cell_ends[std::size_t{index} + 1];
	}
	for (std::size_t index = 1; index < cell_ends.size(); ++index) {
		cell_ends[index] += cell_ends[index - 1];
	}
	r_cells.order.resize(mesh.size());
	r_cells.ranks.resize(mesh.size());
	// Each entry is now the beginning of its cell. The loop advances it to the cell's end.
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		const std::uint32_t slot = cell_ends[indices[i]]++;
		r_cells.order[slot] = static_cast<std::uint32_t>(i);
		r_cells.ranks[slot] = mesh.ranks()[i];
	}
	std::uint32_t begin = 0;
	for (std::uint32_t index = 0; index < cells_per_edge * cells_per_edge; ++index) {
		DrawCell cell{index, begin, cell_ends[index]};
		begin = cell.end;
		if (cell.size() > 0) {
			measure(mesh, r_cells.order_of(cell), cell);
			r_cells.cells.push_back(cell);
		}
	}
}

} // namespace

CellAxes cell_axes(const TileSpace &space, const Planet &planet) {
	if (!planet.exists() || space.covers_all_heights()) {
		return {};
	}
	const glm::dvec2 center = space.center();
	const glm::dvec3 up = glm::abs(glm::dvec3(center.x, 0.5 * (space.bottom + space.top), center.y) - planet.center);
	if (up.y >= up.x && up.y >= up.z) {
		return {};
	}
	return up.x >= up.z ? CellAxes{.column = 1, .row = 2} : CellAxes{.column = 0, .row = 1};
}

Status divide(const CompactMesh &mesh, glm::dvec3 origin, const TileSpace &space, std::uint32_t cells_per_edge,
		DrawCells &r_cells, const CellAxes &axes) {
	r_cells = {};
	const Lattice lattice(space, origin, std::clamp(cells_per_edge, std::uint32_t{1}, max_cells_per_edge), axes);
	DrawCells cells;
	const Status status =
			guarded("instances", static_cast<double>(mesh.size()), [&] { add_cells(mesh, lattice, cells); });
	if (status.ok()) {
		r_cells = std::move(cells);
	}
	return status;
}

void gather(const CompactMesh &mesh, std::span<const std::uint32_t> order, std::span<float> r_buffer) {
	mesh.read(order, r_buffer);
}

void spread(std::span<const float> buffer, std::span<const std::uint32_t> order, std::size_t stride,
		std::span<float> r_buffer) {
	for (std::size_t i = 0; i < order.size(); ++i) {
		std::ranges::copy(buffer.subspan(i * stride, stride), r_buffer.subspan(order[i] * stride, stride).begin());
	}
}

std::vector<CellReuse> reuse_cells(
		const CompactMesh &old_mesh, const DrawCells &old_cells, const CompactMesh &mesh, const DrawCells &cells) {
	const auto is_same = [&](std::uint32_t old_index, std::uint32_t index) {
		return old_mesh.same(old_index, mesh, index);
	};
	std::vector<CellReuse> result;
	result.reserve(cells.cells.size());
	std::size_t old_cell = 0;
	for (const DrawCell &cell : cells.cells) {
		while (old_cell < old_cells.cells.size() && old_cells.cells[old_cell].index < cell.index) {
			++old_cell;
		}
		if (old_cell == old_cells.cells.size() || old_cells.cells[old_cell].index != cell.index) {
			result.emplace_back();
			continue;
		}
		const std::span<const std::uint32_t> order = old_cells.order_of(old_cells.cells[old_cell]);
		result.push_back({old_cell++, std::ranges::equal(order, cells.order_of(cell), is_same)});
	}
	return result;
}

} // namespace thicket
