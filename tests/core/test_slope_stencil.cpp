#include "core/terrain/slope_stencil.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <limits>

using namespace thicket;

namespace {

constexpr float missing = std::numeric_limits<float>::quiet_NaN();

/// Returns the heights of a plane at the stencil's positions, relative to its center. `x` and `z`
/// are its slopes.
std::array<float, 4> plane(const SlopeStencil &stencil, double x, double z) {
	std::array<float, 4> heights{};
	for (std::size_t i = 0; i < heights.size(); ++i) {
		const glm::dvec2 offset = stencil.positions()[i] - stencil.center();
		heights[i] = static_cast<float>(x * offset.x + z * offset.y);
	}
	return heights;
}

} // namespace

TEST_CASE("slope stencil: a plane has its normal everywhere") {
	for (const double shift : {0.0, -3.7, 1e3, -1e6, 3.3e6, 9.9e6, -1e9}) {
		const SlopeStencil stencil({shift, -shift + 0.3});
		const glm::vec3 normal = stencil.normal(0.0F, plane(stencil, 2.0, -0.5));
		const glm::vec3 expected = glm::normalize(glm::vec3{-2.0F, 1.0F, 0.5F});
		CAPTURE(shift);
		CHECK(glm::distance(normal, expected) < 1e-6F);
	}
}

TEST_CASE("slope stencil: positions are floats, half a meter away where precision permits") {
	for (const double x : {0.0, 12.345678901234, -1e6, 1e7, -3e8}) {
		const SlopeStencil stencil({x, 7.0});
		for (const glm::dvec2 &position : stencil.positions()) {
			CHECK(position.x == static_cast<double>(static_cast<float>(position.x)));
			CHECK(position.y == static_cast<double>(static_cast<float>(position.y)));
		}
		CHECK(stencil.positions()[0].x < stencil.center().x);
		CHECK(stencil.positions()[1].x > stencil.center().x);
		if (std::abs(x) <= 1e6) {
			CHECK(stencil.positions()[1].x - stencil.center().x == doctest::Approx(0.5).epsilon(1e-4));
		}
	}
}

TEST_CASE("slope stencil: next to a hole, the slope comes from the remaining ground") {
	const SlopeStencil stencil({100.0, -50.0});
	std::array<float, 4> heights = plane(stencil, 1.0, -1.0);
	const glm::vec3 normal = stencil.normal(0.0F, heights);
	heights[0] = missing;
	heights[3] = std::numeric_limits<float>::infinity();
	CHECK(glm::distance(stencil.normal(0.0F, heights), normal) < 1e-6F);
	heights[1] = missing;
	CHECK(glm::distance(stencil.normal(0.0F, heights), glm::normalize(glm::vec3{0.0F, 1.0F, 1.0F})) < 1e-6F);
	CHECK(stencil.normal(0.0F, std::array<float, 4>{missing, missing, missing, missing}) ==
			glm::vec3{0.0F, 1.0F, 0.0F});
}
