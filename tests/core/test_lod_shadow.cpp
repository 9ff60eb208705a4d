// Tests which levels of detail cast shadows.

#include "core/model/lod_shadow.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace thicket;

namespace {

constexpr glm::dvec3 grass{0.3, 0.5, 0.3};
constexpr glm::dvec3 spruce{4.0, 12.0, 4.0};
constexpr double meadow = 6.8; // Instances per square meter, for a radius of 0.32 m.
constexpr double forest = 0.02;

} // namespace

TEST_CASE("lod shadows: only near LODs of dense and small instances cast a shadow") {
	CHECK(casts_shadow({grass, meadow, 0.0}));
	CHECK(casts_shadow({grass, meadow, 4.9}));
	CHECK_FALSE(casts_shadow({grass, meadow, 5.0}));
	CHECK_FALSE(casts_shadow({grass, meadow, 60.0}));
}

TEST_CASE("lod shadows: every LOD of sparse or large instances casts a shadow") {
	CHECK(casts_shadow({grass, 0.99, 60.0}));
	CHECK_FALSE(casts_shadow({grass, 1.0, 60.0}));
	CHECK(casts_shadow({{1.0, 2.0, 1.0}, meadow, 60.0}));
	CHECK_FALSE(casts_shadow({{1.0, 1.99, 1.0}, meadow, 60.0}));
	CHECK(casts_shadow({spruce, forest, 60.0}));
	CHECK(casts_shadow({spruce, forest, 1500.0}));
}

TEST_CASE("lod shadows: shadows thinner than a pixel of the shadow map are not cast") {
	CHECK(casts_shadow({spruce, forest, 2048.0}));
	CHECK_FALSE(casts_shadow({spruce, forest, 2049.0}));
	CHECK_FALSE(casts_shadow({{0.1, 6.0, 0.1}, forest, 60.0})); // A pole casts none, regardless of its height.
	CHECK(casts_shadow({{0.1, 0.1, 6.0}, forest, 50.0}));
	CHECK(casts_shadow({{1.0, 0.0, 1.0}, forest, 500.0})); // A leaf on a pond casts one because it is wide.
	CHECK_FALSE(casts_shadow({{1.0, 0.0, 1.0}, forest, 513.0}));
	CHECK(casts_shadow({{0.0, 0.0, 0.0}, forest, 0.0}));
}

TEST_CASE("lod shadows: invalid numbers keep the shadow") {
	constexpr double nan = std::numeric_limits<double>::quiet_NaN();
	CHECK(casts_shadow({{nan, nan, nan}, meadow, 60.0}));
	CHECK(casts_shadow({grass, forest, nan}));
	CHECK(casts_shadow({grass, nan, 60.0}));
	CHECK(casts_shadow({{-1.0, -1.0, -1.0}, meadow, 60.0}));
}
