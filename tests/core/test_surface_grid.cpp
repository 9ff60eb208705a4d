#include "core/surface/surface_grid.hpp"

#include <doctest/doctest.h>
#include <glm/vec3.hpp>

#include <cstdint>
#include <cstdlib>
#include <vector>

using namespace thicket;

TEST_CASE("surface grid: neighbors are all cells that a ball can reach, in ascending order") {
	// The box is wider than a word of the grid's bits, so that neighbors cross the border between
	// two words.
	const CellBox box{{-3, 5, -8}, {137, 12, -1}};
	std::vector<glm::ivec3> cells;
	for (std::int32_t z = 0; z < box.size().z; ++z) {
		for (std::int32_t y = 0; y < box.size().y; ++y) {
			for (std::int32_t x = 0; x < box.size().x; ++x) {
				// Regions without cells alternate with regions in which most cells exist.
				if (x / 9 % 3 != 0 && (x * 7 + y * 5 + z * 3) % 4 != 0) {
					cells.emplace_back(x, y, z);
				}
			}
		}
	}
	SurfaceGrid grid;
	grid.build(box, {}, cells);
	REQUIRE(grid.count() == cells.size());
	std::vector<std::uint32_t> neighbors;
	for (std::uint32_t index = 0; index < grid.count(); ++index) {
		std::vector<std::uint32_t> expected;
		for (std::uint32_t other = 0; other < grid.count(); ++other) {
			const glm::ivec3 offset = grid.cell(other) - grid.cell(index);
			if (std::abs(offset.x) <= surface_reach && std::abs(offset.y) <= surface_reach &&
					std::abs(offset.z) <= surface_reach) {
				expected.push_back(other);
			}
		}
		// The neighbors of a cell are appended to the list of the cells before it.
		neighbors.assign(1, index);
		grid.append_neighbors(index, neighbors);
		neighbors.erase(neighbors.begin());
		REQUIRE(neighbors == expected);
	}
}
