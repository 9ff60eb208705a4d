#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/view_focus.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace thicket;

namespace {

/// Waves along x with an amplitude of 40 m. There is no ground beyond x = 1000.
class Hills final : public Terrain {
public:
	static double height(double x) { return 40.0 * std::sin(0.01 * x); }

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		for (std::size_t at = 0; at < positions.size(); ++at) {
			const double x = positions[at].x;
			r_ground[at].height = x < 1000.0 ? static_cast<float>(height(x)) : std::numeric_limits<float>::quiet_NaN();
		}
		return {};
	}
};

glm::dvec3 unit(glm::dvec3 vector) {
	return vector / std::sqrt(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z);
}

void check_near(glm::dvec3 actual, glm::dvec3 expected, double tolerance) {
	CHECK(std::abs(actual.x - expected.x) <= tolerance);
	CHECK(std::abs(actual.y - expected.y) <= tolerance);
	CHECK(std::abs(actual.z - expected.z) <= tolerance);
}

} // namespace

TEST_CASE("view focus: an axis ends where it meets the ground") {
	const FlatTerrain flat(20.0F);
	check_near(view_focus({{3.0, 1700.0, -5.0}, {0.0, -1.0, 0.0}, 4000.0, 0.0}, &flat, 0.0), {3.0, 20.0, -5.0}, 0.2);
	const glm::dvec3 view_direction = unit({1.0, -1.0, 1.0});
	check_near(view_focus({{-980.0, 1000.0, -980.0}, view_direction, 4000.0, 0.0}, &flat, 0.0), {0.0, 20.0, 0.0}, 0.2);

	const Hills hills;
	const glm::dvec3 downward = unit({1.0, -0.5, 0.0});
	const auto hit = ground_on_ray(hills, {0.0, 300.0, 0.0}, downward, 4000.0);
	REQUIRE(hit.has_value());
	CHECK(std::abs(hit->y - Hills::height(hit->x)) < 0.2);
	CHECK(hit->y == doctest::Approx(300.0 - 0.5 * hit->x));
}

TEST_CASE("view focus: a plane replaces missing ground") {
	const Hills hills;
	for (const Terrain *terrain : {static_cast<const Terrain *>(nullptr), static_cast<const Terrain *>(&hills)}) {
		check_near(view_focus({{5000.0, 800.0, 7.0}, {0.0, -1.0, 0.0}, 4000.0, 2000.0}, terrain, 30.0),
				{5000.0, 30.0, 7.0}, 1e-6);
	}
	CHECK_FALSE(ground_on_ray(hills, {5000.0, 800.0, 0.0}, {0.0, -1.0, 0.0}, 4000.0).has_value());
	// The ray starts below the ground.
	CHECK_FALSE(ground_on_ray(hills, {0.0, -800.0, 0.0}, {0.0, -1.0, 0.0}, 4000.0).has_value());
}

TEST_CASE("view focus: an axis along the ground, or one without a hit, ends at the default depth") {
	const FlatTerrain flat;
	for (const glm::dvec3 direction : {glm::dvec3(0.0, 0.0, -1.0), unit({0.0, -0.1, -1.0}), unit({0.0, 1.0, -1.0})}) {
		check_near(view_focus({{0.0, 5.0, 2000.0}, direction, 4000.0, 2000.0}, &flat, 0.0),
				glm::dvec3(0.0, 5.0, 2000.0) + 2000.0 * direction, 1e-6);
	}
	check_near(view_focus({{0.0, 5000.0, 0.0}, {0.0, -1.0, 0.0}, 100.0, 50.0}, &flat, 0.0), {0.0, 4950.0, 0.0}, 1e-6);
}
