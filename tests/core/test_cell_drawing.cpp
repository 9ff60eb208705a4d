#include "core/drawing/cell_drawing.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;

namespace {

LodSettings grass() {
	LodSettings settings;
	settings.lod_distances = {20.0, 60.0};
	settings.thin_begin = 40.0;
	settings.thin_end = 80.0;
	settings.thin_density = 0.25;
	settings.fade = 0.1;
	return settings;
}

const std::vector<LodStep> soft{{false, true}, {false, true}, {false, true}};

bool same(const CellDrawing &a, const CellDrawing &b) {
	return a.span == b.span && a.lod == b.lod && a.scale == b.scale && a.remaining_fraction == b.remaining_fraction;
}

/// Returns `count` ranks that are evenly distributed.
std::vector<std::uint32_t> even_ranks(std::size_t count) {
	std::vector<std::uint32_t> ranks;
	for (std::size_t i = 0; i < count; ++i) {
		ranks.push_back(static_cast<std::uint32_t>((i << 32U) / count));
	}
	return ranks;
}

} // namespace

TEST_CASE("cell drawing: distance determines LOD, thinning and scale") {
	LodSettings settings = grass();
	settings.scale_compensation = true;
	CellDrawing cell;
	adapt(settings, {}, {10.0, 30.0}, cell);
	CHECK(cell.lod == 0);
	CHECK(cell.span == LodSpan{0, 0, false});
	CHECK(cell.remaining_fraction == 1.0);
	CHECK(cell.scale == 1.0F);
	adapt(settings, {}, {80.0, 100.0}, cell);
	CHECK(cell.lod == 2);
	CHECK(cell.span == LodSpan{2, 2, false});
	CHECK(cell.remaining_fraction == 0.25);
	CHECK(cell.scale == 2.0F); // A quarter of the instances is drawn, each twice as wide.
	adapt(settings, {}, {59.0, 79.0}, cell);
	CHECK_MESSAGE(cell.lod == 2, "the coarser LOD stays until 5 % before the distance at which it began");
	adapt(settings, {}, {56.0, 76.0}, cell);
	CHECK(cell.lod == 1);
}

TEST_CASE("cell drawing: LODs that fade are drawn together while the cell is in the range of both") {
	CellDrawing cell;
	adapt(grass(), soft, {10.0, 15.0}, cell);
	CHECK(cell.span == LodSpan{0, 0, false});
	adapt(grass(), soft, {16.0, 22.0}, cell);
	CHECK(cell.span == LodSpan{0, 1, false});
	CHECK(cell.lod == 0); // LOD 0 is drawn alone until LOD 1 has a visual.
	adapt(grass(), soft, {20.6, 26.6}, cell);
	// With hysteresis, the visual is kept slightly beyond the distance at which a new one is added.
	CHECK(cell.span == LodSpan{0, 1, false});
	CellDrawing other;
	other.span = {1, 1, false};
	adapt(grass(), soft, {20.6, 26.6}, other);
	CHECK(other.span == LodSpan{1, 1, false});
	adapt(grass(), soft, {25.0, 35.0}, cell);
	CHECK(cell.span == LodSpan{1, 1, false});
	CHECK(cell.lod == 1);
}

TEST_CASE("cell drawing: within the margin nothing changes") {
	std::mt19937 random(5);
	std::uniform_real_distribution<double> any(0.0, 120.0);
	std::uniform_real_distribution<double> part(-0.999, 0.999);
	for (const bool fades : {false, true}) {
		const std::vector<LodStep> steps = fades ? soft : std::vector<LodStep>();
		for (int round = 0; round < 2000; ++round) {
			CellDrawing cell;
			const double distance = any(random);
			const double size = 10.0;
			adapt(grass(), steps, {distance, distance + size}, cell);
			const double margin = adapted_margin(grass(), steps, {distance, distance + size});
			const double later_distance = std::max(distance + part(random) * std::min(margin, 1000.0), 0.0);
			CellDrawing moved_cell = cell;
			adapt(grass(), steps, {later_distance, later_distance + size}, moved_cell);
			CHECK(same(cell, moved_cell));
		}
	}
	LodSettings plain;
	CHECK(adapted_margin(plain, {}, {10.0, 20.0}) == std::numeric_limits<double>::infinity());
}

TEST_CASE("cell drawing: an additional LOD draws its own fraction, but no instance that the limit has removed") {
	const std::vector<std::uint32_t> ranks = even_ranks(1024);
	CellDrawing cell;
	cell.density = 0.75;
	cell.drawn_count = 768;
	CHECK(drawn_by_extra_lod(ranks, 1.0, 1.0, cell) == 768);
	CHECK(drawn_by_extra_lod(ranks, 1.0, 0.5, cell) == 384);
	cell.drawn_count = 384; // The first LOD draws all instances that its settings permit.
	CHECK(drawn_by_extra_lod(ranks, 0.5, 1.0, cell) == 768);
	cell.drawn_count = 383; // The draw limit has removed one instance.
	CHECK(drawn_by_extra_lod(ranks, 0.5, 1.0, cell) == 383);
	CHECK(drawn_by_extra_lod(ranks, 0.5, 0.25, cell) == 192);
	CHECK(drawn_by_extra_lod({}, 1.0, 1.0, cell) == 0);
}
