// Tests tiles that are divided into cells for drawing. The cells together are bit-identical to the
// tile. A prefix of a cell contains those instances of a prefix of the tile that lie in the cell.

#include "core/drawing/draw_cells.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

DrawCells divided(const CompactMesh &mesh, glm::dvec3 origin, const Rect &rect, std::uint32_t cells_per_edge) {
	DrawCells cells;
	REQUIRE(divide(mesh, origin, rect, cells_per_edge, cells).ok());
	return cells;
}

/// Returns instances at these positions (x, z), relative to the tile's center. Their IDs are 1, 2,
/// 3, and so on.
MeshInstances floats_at(const std::vector<glm::vec2> &positions) {
	MeshInstances mesh;
	mesh.resize(positions.size());
	for (std::size_t i = 0; i < positions.size(); ++i) {
		mesh.floats_of(i)[3] = positions[i].x;
		mesh.floats_of(i)[11] = positions[i].y;
		mesh.ids[i] = i + 1;
		mesh.ranks[i] = static_cast<std::uint32_t>(i);
	}
	return mesh;
}

CompactMesh standing_at(const std::vector<glm::vec2> &positions) { return {floats_at(positions), nullptr, {}}; }

std::vector<std::uint32_t> numbers_of(const DrawCells &cells, std::size_t size) {
	std::vector<std::uint32_t> numbers(size);
	for (const DrawCell &cell : cells.cells) {
		for (const std::uint32_t i : cells.order_of(cell)) {
			numbers[i] = cell.index;
		}
	}
	return numbers;
}

} // namespace

TEST_CASE("draw cells: all cells together are bit-identical to the tile, for every number of cells") {
	const TileInstances tile = built(rich_layer(), hills(), tile_of_hills);
	const std::shared_ptr<const CompactTile> stored = compact_tile(rich_layer(), tile);
	for (std::size_t at = 0; at < tile.meshes.size(); ++at) {
		const MeshInstances &mesh = tile.meshes[at];
		REQUIRE(mesh.size() > 100);
		for (const std::uint32_t cells_per_edge : {1U, 2U, 3U, 4U, 7U, 16U}) {
			const CompactMesh &compact = stored->meshes[at];
			const DrawCells cells = divided(compact, tile.origin, tile_of_hills, cells_per_edge);
			std::vector<float> joined(mesh.buffer.size());
			std::size_t count = 0;
			for (const DrawCell &cell : cells.cells) {
				std::vector<float> buffer(cell.size() * mesh.stride);
				gather(compact, cells.order_of(cell), buffer);
				spread(buffer, cells.order_of(cell), mesh.stride, joined);
				count += cell.size();
			}
			CHECK(count == mesh.size());
			CHECK(std::ranges::equal(joined, mesh.buffer));
			CHECK(cells.cells.size() <= cells_per_edge * cells_per_edge);
			CHECK(std::set<std::uint32_t>(cells.order.begin(), cells.order.end()).size() == mesh.size());
		}
	}
}

TEST_CASE("draw cells: a cell keeps the tile's order, so thinning a cell matches thinning the tile") {
	const std::shared_ptr<const CompactTile> tile =
			compact_tile(rich_layer(), built(rich_layer(), hills(), tile_of_hills));
	for (const CompactMesh &mesh : tile->meshes) {
		const DrawCells cells = divided(mesh, tile->origin, tile_of_hills, 4);
		CHECK(cells.cells.size() > 4);
		for (const double density : {0.0, 0.1, 0.25, 0.7, 1.0}) {
			std::size_t drawn_count = 0;
			for (const DrawCell &cell : cells.cells) {
				CHECK(std::ranges::is_sorted(cells.order_of(cell)));
				const std::size_t prefix = visible_prefix(cells.ranks_of(cell), density);
				for (const std::uint32_t i : cells.order_of(cell).first(prefix)) {
					CHECK(i < visible_prefix(mesh.ranks(), density));
				}
				drawn_count += prefix;
			}
			CHECK(drawn_count == visible_prefix(mesh.ranks(), density));
		}
	}
}

TEST_CASE("draw cells: each cell has the instances in its square, and the box around them") {
	const TileInstances tile = built(rich_layer(), hills(), tile_of_hills);
	const MeshInstances &mesh = tile.meshes[0];
	const DrawCells cells = divided(CompactMesh(mesh, nullptr, tile.origin), tile.origin, tile_of_hills, 4);
	for (const DrawCell &cell : cells.cells) {
		const glm::dvec2 corner = tile_of_hills.min + 32.0 * glm::dvec2(cell.index % 4, cell.index / 4);
		glm::vec3 min(1e9f);
		glm::vec3 max(-1e9f);
		for (const std::uint32_t i : cells.order_of(cell)) {
			const glm::dvec3 at = world_position(tile, mesh, i);
			CHECK(Rect{corner, corner + 32.0}.contains({at.x, at.z}));
			min = glm::min(min, glm::vec3(at - tile.origin));
			max = glm::max(max, glm::vec3(at - tile.origin));
		}
		CHECK(cell.min == min);
		CHECK(cell.max == max);
	}
}

TEST_CASE("draw cells: squares are half-open, and instances outside the tile are in the nearest cell") {
	const Rect rect{{-64.0, 0.0}, {64.0, 128.0}};
	const CompactMesh mesh = standing_at({{-64.0f, -64.0f}, {-32.0f, -64.0f}, {std::nextafter(-32.0f, -64.0f), -64.0f},
			{0.0f, 0.0f}, {-1e-30f, -1e-30f}, {64.0f, 64.0f}, {-70.0f, 0.0f}, {500.0f, -500.0f}});
	const DrawCells cells = divided(mesh, {0.0, 7.0, 64.0}, rect, 4);
	CHECK(numbers_of(cells, mesh.size()) == std::vector<std::uint32_t>{0, 1, 0, 10, 5, 15, 8, 3});
}

TEST_CASE("draw cells: an empty tile has no cells, and numbers of cells are clamped") {
	CHECK(divided(CompactMesh(), {}, tile_of_hills, 4).empty());
	const CompactMesh mesh = standing_at({{-63.0f, -63.0f}, {63.0f, 63.0f}});
	CHECK(divided(mesh, {0.0, 0.0, 64.0}, tile_of_hills, 0).cells.size() == 1);
	CHECK(divided(mesh, {0.0, 0.0, 64.0}, tile_of_hills, 1000).cells.back().index == 255);
}

TEST_CASE("draw cells: after a change, only cells whose instances differ need an upload") {
	// The first and the last quarter have two instances each, the other quarters one.
	const std::vector<glm::vec2> positions{
			{-10.0f, -10.0f}, {10.0f, -10.0f}, {-10.0f, 10.0f}, {10.0f, 10.0f}, {-11.0f, -11.0f}, {11.0f, 11.0f}};
	const glm::dvec3 origin{0.0, 0.0, 64.0};
	const auto reused = [&](const MeshInstances &current) {
		const CompactMesh before = standing_at(positions);
		const CompactMesh after(current, nullptr, origin);
		const std::vector<CellReuse> result = reuse_cells(
				before, divided(before, origin, tile_of_hills, 2), after, divided(after, origin, tile_of_hills, 2));
		// The index of each cell's former cell, or -1 if there is none; plus 10 if the cell is
		// unchanged.
		std::vector<int> cells;
		for (const auto &[from, unchanged] : result) {
			cells.push_back((from ? static_cast<int>(*from) : -1) + (unchanged ? 10 : 0));
		}
		return cells;
	};
	MeshInstances current = floats_at(positions);
	CHECK(reused(current) == std::vector{10, 11, 12, 13});
	current.floats_of(4)[0] = 1.0f;
	CHECK(reused(current) == std::vector{0, 11, 12, 13}); // An instance of the first cell is turned.
	CHECK(reused(floats_at({positions.begin(), positions.end() - 1})) == std::vector{10, 11, 12, 3});
	current = floats_at({positions[0], positions[3], positions[4], positions[5]});
	current.ids = {1, 4, 5, 6};
	CHECK(reused(current) == std::vector{10, 13}); // The other quarters are empty now, so they have no cell.
	CHECK(reused(floats_at({})).empty());
}

TEST_CASE("draw cells: a cell that had no instances is new") {
	const glm::dvec3 origin{0.0, 0.0, 64.0};
	const CompactMesh before = standing_at({{10.0f, 10.0f}});
	const CompactMesh after = standing_at({{10.0f, 10.0f}, {-10.0f, -10.0f}, {20.0f, -20.0f}});
	const std::vector<CellReuse> cells = reuse_cells(
			before, divided(before, origin, tile_of_hills, 2), after, divided(after, origin, tile_of_hills, 2));
	REQUIRE(cells.size() == 3);
	CHECK_FALSE(cells[0].old_cell);
	CHECK_FALSE(cells[0].is_unchanged);
	CHECK_FALSE(cells[1].old_cell);
	CHECK(cells[2].old_cell == 0U);
	CHECK(cells[2].is_unchanged);
}

TEST_CASE("draw cells: the cubes of a planet are divided along the two axes that are nearest to the ground") {
	const Planet planet{{10.0, 20.0, 30.0}, 1000.0};
	const auto axes_at = [&planet](const glm::dvec3 &direction) {
		const glm::dvec3 at = planet.center + 1000.0 * direction;
		return cell_axes({{{at.x - 8.0, at.z - 8.0}, {at.x + 8.0, at.z + 8.0}}, at.y - 8.0, at.y + 8.0}, planet);
	};
	for (const double side : {-1.0, 1.0}) {
		CHECK(axes_at({0.1, side, 0.3}) == CellAxes{.column = 0, .row = 2});
		CHECK(axes_at({side, 0.9, 0.3}) == CellAxes{.column = 1, .row = 2});
		CHECK(axes_at({0.1, 0.5, side}) == CellAxes{.column = 0, .row = 1});
	}
	CHECK(cell_axes(tile_of_hills, planet) == CellAxes{});
	CHECK(cell_axes({tile_of_hills, -8.0, 8.0}, Planet()) == CellAxes{});

	const TileSpace cube({{0.0, 0.0}, {8.0, 8.0}}, 16.0, 24.0);
	MeshInstances floats = floats_at({{-3.0f, -3.0f}, {-3.0f, 3.0f}, {-3.0f, -3.0f}, {-3.0f, 3.0f}});
	for (std::size_t i = 0; i < floats.size(); ++i) {
		floats.floats_of(i)[7] = i < 2 ? -3.0f : 3.0f; // World y.
	}
	const CompactMesh mesh(floats, nullptr, {});
	DrawCells cells;
	REQUIRE(divide(mesh, {4.0, 20.0, 4.0}, cube, 2, cells, {.column = 1, .row = 2}).ok());
	CHECK(numbers_of(cells, 4) == std::vector<std::uint32_t>{0, 2, 1, 3});
	REQUIRE(divide(mesh, {4.0, 20.0, 4.0}, cube, 2, cells, {.column = 0, .row = 1}).ok());
	CHECK(numbers_of(cells, 4) == std::vector<std::uint32_t>{0, 0, 2, 2});
	CHECK(cells.cells.back().min.y == 3.0f);
}
