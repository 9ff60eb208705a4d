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

	std::uint32_t along(const glm::vec3 &position, int axis) const {
		return cell_along(double{position[axis]}, edge[axis], cell_size[axis], cells_per_edge);
	}

	std::uint16_t number(const glm::vec3 &position) const {
		return static_cast<std::uint16_t>(along(position, axes.row) * cells_per_edge + along(position, axes.column));
	}
};

/// Returns the cell number of each instance. All functions below may throw std::bad_alloc.
std::vector<std::uint16_t> cell_numbers(const CompactMesh &mesh, const Lattice &lattice) {
	std::vector<std::uint16_t> numbers(mesh.size());
	std::ranges::transform(mesh.positions(), numbers.begin(),
			[&lattice](const glm::vec3 &position) { return lattice.number(position); });
	return numbers;
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
	const std::vector<std::uint16_t> numbers = cell_numbers(mesh, lattice);
	// The cells are filled by a counting sort. First, ends[number + 1] counts the instances of a
	// cell.
	std::vector<std::uint32_t> ends(std::size_t{cells_per_edge} * cells_per_edge + 1);
	for (const std::uint16_t number : numbers) {
		++ends[std::size_t{number} + 1];
	}
	for (std::size_t number = 1; number < ends.size(); ++number) {
		ends[number] += ends[number - 1];
	}
	r_cells.order.resize(mesh.size());
	r_cells.ranks.resize(mesh.size());
	// Each entry is now the beginning of its cell. The loop advances it to the cell's end.
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		const std::uint32_t at = ends[numbers[i]]++;
		r_cells.order[at] = static_cast<std::uint32_t>(i);
		r_cells.ranks[at] = mesh.ranks()[i];
	}
	std::uint32_t begin = 0;
	for (std::uint32_t number = 0; number < cells_per_edge * cells_per_edge; ++number) {
		DrawCell cell{number, begin, ends[number]};
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
	const glm::dvec2 middle = space.center();
	const glm::dvec3 up = glm::abs(glm::dvec3(middle.x, 0.5 * (space.bottom + space.top), middle.y) - planet.center);
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

std::vector<CellReuse> reuse_cells(const CompactMesh &mesh_before, const DrawCells &cells_before,
		const CompactMesh &mesh, const DrawCells &cells) {
	const auto same = [&](std::uint32_t at_before, std::uint32_t at) {
		return mesh_before.same(at_before, mesh, at);
	};
	std::vector<CellReuse> result;
	result.reserve(cells.cells.size());
	std::size_t before = 0;
	for (const DrawCell &cell : cells.cells) {
		while (before < cells_before.cells.size() && cells_before.cells[before].number < cell.number) {
			++before;
		}
		if (before == cells_before.cells.size() || cells_before.cells[before].number != cell.number) {
			result.emplace_back();
			continue;
		}
		const std::span<const std::uint32_t> order = cells_before.order_of(cells_before.cells[before]);
		result.push_back({before++, std::ranges::equal(order, cells.order_of(cell), same)});
	}
	return result;
}

} // namespace thicket
