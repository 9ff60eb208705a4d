// Tests the estimated number of a layer's instances around a viewer.

#include "core/base/tile_grid.hpp"
#include "core/streaming/view_estimate.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace thicket;

namespace {

/// Returns the number of tiles within the view distance of a viewer in tile (0, 0).
int tiles_in_view(const StreamLayer &layer, glm::dvec2 viewer) {
	int count = 0;
	for (int y = -10; y <= 10; ++y) {
		for (int x = -10; x <= 10; ++x) {
			const double squared = distance_squared(tile_rect(layer.tile_size, {x, y}), viewer);
			count += squared <= layer.view_distance * layer.view_distance ? 1 : 0;
		}
	}
	return count;
}

} // namespace

TEST_CASE("the area in view is the area of the tiles around a viewer, over all its positions") {
	for (const double radius : {0.0, 20.0, 64.0, 200.0}) {
		const StreamLayer layer{32.0, radius};
		constexpr int steps = 64;
		double area = 0.0;
		for (int step = 0; step < steps * steps; ++step) {
			const glm::dvec2 viewer((step % steps + 0.5) / steps * 32.0, (step / steps + 0.5) / steps * 32.0);
			area += tiles_in_view(layer, viewer) * 32.0 * 32.0 / (steps * steps);
		}
		CHECK(view_area(layer) == doctest::Approx(area).epsilon(0.01));
	}
}

TEST_CASE("expected instances follow the point density, the kept fraction and the area") {
	const StreamLayer layer{32.0, 64.0};
	const double all = expected_instances(0.2, 1.0, layer);
	CHECK(all == doctest::Approx(0.2 * view_area(layer)));
	CHECK(expected_instances(0.2, 0.25, layer) == doctest::Approx(0.25 * all));
	CHECK(expected_instances(0.8, 1.0, layer) == doctest::Approx(4.0 * all));
}
