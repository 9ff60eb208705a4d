#include "core/base/view_volume.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace thicket;

namespace {

/// Returns a frustum from the origin along -z, with a field of view of 90 degrees on both axes,
/// from 1 to 100 m.
ViewVolume straight_ahead() {
	return ViewVolume({{{-1, 1, -1}, {1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-100, 100, -100}, {100, 100, -100},
			{100, -100, -100}, {-100, -100, -100}}});
}

} // namespace

TEST_CASE("view volume: a point is visible exactly if it is inside") {
	const ViewVolume view = straight_ahead();
	std::mt19937 random(3);
	std::uniform_real_distribution<double> along(-120.0, 120.0);
	int visible_count = 0;
	for (int i = 0; i < 20000; ++i) {
		const glm::dvec3 at(along(random), along(random), along(random));
		const double depth = -at.z;
		const bool within = depth >= 1.0 && depth <= 100.0 && std::abs(at.x) <= depth && std::abs(at.y) <= depth;
		CHECK(view.touches(at, at) == within);
		visible_count += within ? 1 : 0;
	}
	CHECK(visible_count > 1000);
}

TEST_CASE("view volume: a box is visible if a part of it is") {
	const ViewVolume view = straight_ahead();
	CHECK(view.touches({-500, -500, -500}, {500, 500, 500}));
	CHECK(view.touches({40, -1, -50}, {60, 1, -45}));
	CHECK_FALSE(view.touches({51, -1, -50}, {60, 1, -45}));
	CHECK_FALSE(view.touches({-5, -5, 1}, {5, 5, 6}));
	CHECK_FALSE(view.touches({-5, -5, -200}, {5, 5, -101}));
}

TEST_CASE("view volume: orthogonal cameras and corners in reverse order are supported") {
	const ViewVolume view(
			{{{0, 0, 0}, {0, 10, 0}, {20, 10, 0}, {20, 0, 0}, {0, 0, 50}, {0, 10, 50}, {20, 10, 50}, {20, 0, 50}}});
	CHECK(view.touches({5, 5, 5}, {6, 6, 6}));
	CHECK_FALSE(view.touches({21, 5, 5}, {22, 6, 6}));
	CHECK_FALSE(view.touches({5, -2, 5}, {6, -1, 6}));
	CHECK_FALSE(view.touches({5, 5, 51}, {6, 6, 60}));
}
