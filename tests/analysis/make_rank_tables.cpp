// Measures the tables of extension/core/sampling/rank_tables.inc: `make_rank_tables [million points a stage]` prints
// them. A stage is a level of the progressive order, counted from the coarsest. The process has no scale, so one seed
// and radius are enough. From the fourth stage on, the coarser points are similar, and so is the table.

#include "core/sampling/block_sampler.hpp"
#include "core/sampling/rank.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <thread>
#include <vector>

namespace {

using namespace thicket;

constexpr std::int32_t block_side = 128;

/// Keeps level and time readable in place of the rank.
std::uint32_t raw_rank(std::uint32_t, std::uint32_t level, TimeKey time) { return level << 28 | time >> 3; }

struct Measured {
	std::vector<std::uint64_t> knots = std::vector<std::uint64_t>(rank_knots + 1);
	std::uint64_t points = 0; ///< Of all levels.
	std::uint64_t cells = 0;
	std::uint64_t finest = 0; ///< Placed at the finest level.
};

void measure(
		std::uint32_t levels, std::int32_t first_row, std::int32_t rows, std::int32_t columns, Measured &r_measured) {
	BlockSampler blocks;
	PointSet set;
	set.seed = 0x7461626c65;
	set.levels = levels;
	blocks.prepare(set, raw_rank);
	for (std::int32_t row = first_row; row < rows; row += 2) {
		for (std::int32_t column = 0; column < columns; ++column) {
			const glm::ivec2 corner = glm::ivec2(column, row) * block_side;
			if (blocks.resolve({corner, corner + block_side}, nullptr) != ResolveResult::done) {
				std::abort();
			}
			const LevelGrid &grid = blocks.finest();
			for (std::int32_t y = 0; y < block_side; ++y) {
				for (std::int32_t x = 0; x < block_side; ++x) {
					const std::uint32_t index = grid.index_of(corner + glm::ivec2(x, y));
					if (grid.point[index] == LevelGrid::no_point) {
						continue;
					}
					++r_measured.points;
					if (grid.dart[index] >> 28 == 0) {
						++r_measured.finest;
						++r_measured.knots[rank_knot(grid.dart[index] << 3)];
					}
				}
			}
			r_measured.cells += block_side * block_side;
		}
	}
}

} // namespace

int main(int argc, char **argv) {
	const double million = argc > 1 ? std::atof(argv[1]) : 4.0;
	const auto side = static_cast<std::int32_t>(std::sqrt(million * 1e6 / (0.35 * block_side * block_side))) + 1;
	std::array<double, rank_stages> density{};
	std::printf("// Made by tests/analysis/make_rank_tables.cpp with %g million points a stage.\n", million);
	std::printf("// Share of a stage's own points, in 2^-32, whose time lies before each knot of rank.hpp.\n");
	for (std::uint32_t stage = 0; stage < rank_stages; ++stage) {
		std::array<Measured, 2> halves;
		std::thread other(measure, stage + 1, 0, side, side, std::ref(halves[0]));
		measure(stage + 1, 1, side, side, halves[1]);
		other.join();
		const std::uint64_t finest = halves[0].finest + halves[1].finest;
		// Two cells have the area radius^2.
		density[stage] = 2.0 * static_cast<double>(halves[0].points + halves[1].points) /
				static_cast<double>(halves[0].cells + halves[1].cells);
		std::printf("{");
		std::uint64_t before = 0;
		for (std::uint32_t knot = 0; knot < rank_knots; ++knot) {
			before += halves[0].knots[knot] + halves[1].knots[knot];
			const double share = static_cast<double>(before) / static_cast<double>(finest);
			std::printf("%s%uu,", knot % 10 == 0 ? "\n" : " ", static_cast<unsigned>(share * 4294967295.0));
		}
		std::printf("\n},\n");
	}
	std::printf("// Points in radius^2 once a stage has run to its end:");
	for (const double value : density) {
		std::printf(" %.6f", value);
	}
	std::printf("\n");
	return 0;
}
