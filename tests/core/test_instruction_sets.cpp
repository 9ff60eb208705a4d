// Tests that results are bit-identical with every instruction set of this processor, and with the
// emulated one that works on all processors.

#include "domain_cases.hpp"
#include "surface_fixture.hpp"
#include "tests/bench/common/simd_targets.hpp"
#include "tilings.hpp"

#include <doctest/doctest.h>

using namespace thicket;
using namespace thicket::tilings;

namespace {

void check_all_targets(const PointSet &set, const Rect &rect) {
	const std::vector<bench::SimdTarget> targets = bench::simd_targets();
	REQUIRE(!targets.empty());
	std::vector<SamplePoint> expected;
	for (const bench::SimdTarget &target : targets) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		TileSampler sampler;
		std::vector<SamplePoint> points;
		REQUIRE(sampler.sample(set, rect, points).ok());
		if (expected.empty()) {
			expected = points;
		}
		// The order must be the same as well, because it depends only on the arguments.
		const bool identical = points == expected;
		CHECK(identical);
	}
	CHECK(expected.size() > 20'000);
}

} // namespace

TEST_CASE("instruction sets: the same points in the same order, plain set") {
	check_all_targets({.seed = 41, .radius = 1.0, .levels = 1, .layer = 2}, {{-130.0, -20.0}, {170.0, 280.0}});
}

TEST_CASE("instruction sets: the same points in the same order, progressive set, far away") {
	check_all_targets(
			{.seed = 42, .radius = 1.0, .levels = 5, .layer = 3}, {{-5.0e6, 5.0e6}, {-5.0e6 + 200.0, 5.0e6 + 200.0}});
}

TEST_CASE_TEMPLATE("instruction sets: the same points in the same order, whole domains", Real, float, double) {
	for (const domain_cases::Method &method : domain_cases::methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			// The default cell size of the method, cells with one point, and cells that overflow.
			for (const double cell_size : {0.0, 0.1, 9.0}) {
				CAPTURE(cell_size);
				DomainRequest request = domain_cases::request_of({"", {60.0, 41.0}, 1.0, torus}, method.method, 43);
				request.cell_size = cell_size;
				request.darts_each = 10.0;
				std::vector<glm::vec<2, Real>> expected;
				for (const bench::SimdTarget &target : bench::simd_targets()) {
					CAPTURE(target.name);
					const bench::ForcedTarget forced(target);
					const std::vector<glm::vec<2, Real>> points = domain_cases::sampled<Real>(request);
					expected = expected.empty() ? points : expected;
					const bool identical = points == expected;
					CHECK(identical);
				}
			}
		}
	}
}

TEST_CASE("instruction sets: the same points in the same order, surfaces") {
	for (const std::uint32_t levels : {1U, 3U}) {
		const PointSet set{.seed = 44, .radius = 1.0, .levels = levels, .layer = 4};
		const auto sphere = surfaces::sphere(15.0, 30).surface();
		const auto slope = surfaces::facing(glm::normalize(glm::dvec3(1.0, 1.0, 1.0)), 60.0, 20).surface();
		for (const std::shared_ptr<const Surface> &surface : {sphere, slope}) {
			std::vector<SurfacePoint> expected;
			for (const bench::SimdTarget &target : bench::simd_targets()) {
				CAPTURE(target.name);
				const bench::ForcedTarget forced(target);
				const std::vector<SurfacePoint> points = surfaces::all_points(set, *surface);
				if (expected.empty()) {
					expected = points;
				}
				const bool identical = points == expected;
				CHECK(identical);
			}
			CHECK(expected.size() > 1000);
		}
	}
}

TEST_CASE("instruction sets: the emulated instruction set is tested, too") {
	// Otherwise, the tests above would compare fewer targets than intended.
	const std::vector<bench::SimdTarget> targets = bench::simd_targets();
	CHECK(std::ranges::any_of(targets, [](const bench::SimdTarget &target) {
		return target.name == "EMU128" || target.name == "SCALAR" || target.name.starts_with("NEON");
	}));
}
