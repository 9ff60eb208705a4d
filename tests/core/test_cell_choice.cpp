// Tests how finely tiles are divided for drawing: more finely near the camera, only where the
// division changes the image, and with hysteresis.

#include "core/drawing/cell_choice.hpp"

#include "core/drawing/draw_cells.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace thicket;

namespace {

constexpr CellSettings settings{128.0, 4};

LodSettings lods(std::vector<double> distances) {
	LodSettings lod;
	lod.lod_distances = std::move(distances);
	return lod;
}

} // namespace

TEST_CASE("cell choice: a tile is divided evenly into cells nearest to the requested size") {
	CHECK(cell_count_per_edge(128.0, 32.0) == 4);
	CHECK(cell_count_per_edge(128.0, 40.0) == 3);
	CHECK(cell_count_per_edge(128.0, 100.0) == 1);
	CHECK(cell_count_per_edge(128.0, 128.0) == 1);
	CHECK(cell_count_per_edge(128.0, 1e9) == 1);
	CHECK(cell_count_per_edge(32.0, 24.0) == 1);
	CHECK(cell_count_per_edge(1e6, 1.0) == max_cells_per_edge);
	for (const double bad : {0.0, -5.0, std::numeric_limits<double>::quiet_NaN()}) {
		CHECK(cell_count_per_edge(128.0, bad) == 1);
	}
}

TEST_CASE("cell choice: the default size depends on the model's size and the instances' density") {
	CHECK(default_cell_size(12.0, 1.0) == 32.0);
	CHECK(default_cell_size(4.0, 1.0) == 32.0);
	CHECK(default_cell_size(16.0, 1.0) == 32.0);
	CHECK(default_cell_size(3.5, 1.0) == 28.0);
	CHECK(default_cell_size(0.2, 1.0) == 24.0);
	CHECK(default_cell_size(0.0, 0.0) == 24.0);
	CHECK(default_cell_size(40.0, 1.0) == 80.0);
	const double sparse = default_cell_size(12.0, 0.002);
	CHECK(sparse * sparse * 0.002 == doctest::Approx(min_instances_per_cell));
}

TEST_CASE("cell choice: near tiles are divided into cells, far ones are whole") {
	const LodSettings lod = lods({40.0, 150.0});
	CHECK(division_at(settings, lod, 0.0, 0) == 4);
	CHECK(division_at(settings, lod, 39.0, 0) == 4);
	CHECK(division_at(settings, lod, 41.0, 0) == 2);
	CHECK(division_at(settings, lod, 149.0, 0) == 2);
	CHECK(division_at(settings, lod, 151.0, 0) == 1);
	CHECK(division_at(settings, lods({1000.0}), 900.0, 0) == 1);
	CHECK(division_at({128.0, 1}, lod, 0.0, 0) == 1);
	CHECK(division_at({}, lod, 0.0, 0) == 1);
}

TEST_CASE("cell choice: a tile without changes inside it is drawn as a whole") {
	CHECK(division_at(settings, {}, 0.0, 0) == 1);
	CHECK(division_at(settings, lods({10.0}), 0.0, 0) == 4);
	CHECK(division_at(settings, lods({10.0}), 11.0, 0) == 1);
	CHECK(division_at(settings, lods({200.0}), 0.0, 0) == 1);
	CHECK(division_at(settings, lods({200.0}), 50.0, 0) == 2);
	CHECK(division_at(settings, lods({500.0}), 400.0, 0) == 1);
	LodSettings thinning;
	thinning.thin_begin = 50.0;
	thinning.thin_end = 170.0;
	CHECK(division_at(settings, thinning, 100.0, 0) == 1); // No thinning at this distance.
	thinning.thin_density = 0.5;
	CHECK(division_at(settings, thinning, 100.0, 0) == 4);
	CHECK(division_at(settings, thinning, 169.0, 0) == 2);
	CHECK(division_at(settings, thinning, 171.0, 0) == 1);
}

TEST_CASE("cell choice: moving back and forth within a tenth of a tile repeats no change") {
	for (const LodSettings &lod :
			{LodSettings(), lods({40.0, 150.0}), lods({100.0}), lods({20.0, 21.0, 130.0}), lods({250.0})}) {
		for (double middle = 0.0; middle < 300.0; middle += 1.0) {
			std::uint32_t displayed_count = 0;
			int changes = 0;
			for (int step = 0; step < 200; ++step) {
				const double distance = std::max(middle + 6.3 * std::sin(step * 0.7), 0.0);
				const std::uint32_t cells_per_edge = division_at(settings, lod, distance, displayed_count);
				changes += cells_per_edge != displayed_count ? 1 : 0;
				displayed_count = cells_per_edge;
			}
			CHECK(changes <= 2); // The first change shows the tile.
		}
	}
}

TEST_CASE("cell choice: a tile needs no check before its result can change") {
	const LodSettings lod = lods({40.0, 150.0});
	CHECK(division_margin(settings, lod, 1000.0) > 700.0);
	for (double distance = 0.0; distance < 1000.0; distance += 0.5) {
		const double margin = division_margin(settings, lod, distance);
		CHECK(margin >= 16.0);
		if (margin > 16.0) {
			for (const double other : {distance - margin + 1e-6, distance + margin}) {
				CHECK(division_at(settings, lod, other, 1) == division_at(settings, lod, distance, 1));
			}
		}
	}
	CHECK(division_margin({128.0, 1}, lod, 50.0) == std::numeric_limits<double>::infinity());
	CHECK(division_margin(settings, {}, 50.0) == std::numeric_limits<double>::infinity());
}
