// Measures the table that makes the clump noise uniform, and the distance between its maxima. `make_clump_table
// [million places]` prints extension/core/rules/clump_table.inc, with the mean distance in cells on its last line. The
// noise has the same statistics everywhere and for every seed, so one seed is enough.

#include "core/rules/clump_impulses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

using namespace thicket;

constexpr std::uint64_t seed = 0x636c756d7073;

void print_table(int million_places) {
	std::array<std::uint64_t, clump_knots> nearer{};
	std::mt19937_64 random(1);
	const auto coordinate = [&random] {
		return static_cast<double>(random() >> 11) * 0x1p-33; // Up to 2^20 cells.
	};
	const std::uint64_t places = std::uint64_t{1000000} * static_cast<std::uint64_t>(million_places);
	for (std::uint64_t i = 0; i < places; ++i) {
		const double x = coordinate();
		const double noise = std::abs(clump_impulses({x, coordinate()}, seed));
		// Counted at the first knot beyond it. Summing them later produces the number below each knot.
		const auto knot = static_cast<std::size_t>(noise * clump_knots_per_unit) + 1;
		++nearer[std::min(knot, nearer.size() - 1)];
	}
	std::printf(
			"// Made by tests/analysis/make_clump_table.cpp with %d million places.\n"
			"// Part of the plane where the clump noise lies nearer to 0 than each knot; whatever is beyond the last "
			"one counts to it.\n{\n",
			million_places);
	std::uint64_t sum = 0;
	for (std::size_t knot = 0; knot < nearer.size(); ++knot) {
		sum += nearer[knot];
		std::printf("%.6f,%c", static_cast<double>(sum) / static_cast<double>(places),
				knot % 10 == 9 || knot + 1 == nearer.size() ? '\n' : ' ');
	}
	std::printf("}\n");
}

/// The mean distance between n maxima on an area A, as for a square lattice: sqrt(A / n).
double distance_of_maxima() {
	constexpr int steps_per_cell = 32;
	constexpr std::size_t side = 400 * steps_per_cell;
	std::array<std::vector<double>, 3> rows;
	std::uint64_t maxima = 0;
	for (std::size_t y = 0; y < side; ++y) {
		std::rotate(rows.begin(), rows.begin() + 1, rows.end());
		rows[2].resize(side);
		for (std::size_t x = 0; x < side; ++x) {
			rows[2][x] = clump_impulses(glm::dvec2(x, y) / double{steps_per_cell}, seed);
		}
		for (std::size_t x = 1; y >= 2 && x + 1 < side; ++x) {
			const auto before = [&](const std::vector<double> &row) {
				return std::max({row[x - 1], row[x], row[x + 1]});
			};
			const double around = std::max({before(rows[0]), before(rows[2]), rows[1][x - 1], rows[1][x + 1]});
			maxima += rows[1][x] > around;
		}
	}
	const double cells = static_cast<double>(side) / steps_per_cell;
	return cells / std::sqrt(static_cast<double>(maxima));
}

} // namespace

int main(int argument_count, char **arguments) {
	const int million_places = argument_count > 1 ? std::atoi(arguments[1]) : 100;
	if (million_places < 1) {
		std::fprintf(stderr, "usage: make_clump_table [million places >= 1]\n");
		return EXIT_FAILURE;
	}
	print_table(million_places);
	std::printf("// maxima: one for each square of %.4f cells on a side\n", distance_of_maxima());
	return EXIT_SUCCESS;
}
