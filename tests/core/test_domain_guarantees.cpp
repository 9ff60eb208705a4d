// Tests guarantees 1 to 3 of DomainSampler on all kinds of domains. No pair is closer than the
// radius, even across the seams of a torus. The sets are maximal: in single precision, every
// representable position is covered. All points lie within the domain.

#include "domain_cases.hpp"

using namespace thicket;
using namespace thicket::domain_cases;

TEST_CASE_TEMPLATE("domain: distance, coverage and bounds on domains of all shapes", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const Shape &shape : shapes) {
			CAPTURE(shape.name);
			for (std::uint64_t seed = 1; seed <= 3; ++seed) {
				const DomainRequest request = request_of(shape, method.method, seed);
				check_guarantees<Real>(request, sampled<Real>(request));
			}
		}
	}
}

TEST_CASE_TEMPLATE("domain: all counts of base squares and groups along each axis", Real, float, double) {
	// Sizes just below and above each whole number of base squares, up to three and a half groups,
	// and the smallest tori.
	std::vector<double> bounded;
	for (int squares = 0; squares <= 10; ++squares) {
		for (const double excess : {-0.01, 0.01, 0.5}) {
			bounded.push_back((squares + excess) * std::sqrt(0.5));
		}
	}
	std::erase_if(bounded, [](double side) { return side <= 0.0; });
	const std::vector<double> toroidal = {4.0, 4.2, 4.3, 4.9, 5.0, 5.6, 5.7, 6.3, 6.4, 7.0, 7.1, 8.4, 8.5};
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			const std::vector<double> &sides = torus ? toroidal : bounded;
			for (const double x : sides) {
				CAPTURE(x);
				for (const double y : sides) {
					CAPTURE(y);
					const DomainRequest request = request_of({"", {x, y}, 0.75, torus}, method.method, 5);
					check_guarantees<Real>(request, sampled<Real>(request));
				}
			}
		}
	}
}

TEST_CASE_TEMPLATE("domain: a domain that one disk always covers gets one point", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (std::uint64_t seed = 0; seed < 20; ++seed) {
			for (const glm::dvec2 size : {glm::dvec2(0.7, 0.7), glm::dvec2(0.99, 0.1), glm::dvec2(1e-4, 0.9)}) {
				CHECK(sampled<Real>(request_of({"", size, 1.0, false}, method.method, seed)).size() == 1);
			}
		}
	}
}

TEST_CASE_TEMPLATE("domain: a width of ten thousand radii", Real, float, double) {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			for (const glm::dvec2 radii : {glm::dvec2(10'000.0, 5.3), glm::dvec2(5.3, 10'000.0)}) {
				const DomainRequest request = request_of({"", radii, 1.3, torus}, method.method, 7);
				check_guarantees<Real>(request, sampled<Real>(request));
			}
		}
	}
}

TEST_CASE("domain: the largest width in single precision") {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		const DomainRequest request = request_of({"", {1.1, max_single_radii}, 1.0, false}, method.method, 8);
		check_guarantees<float>(request, sampled<float>(request));
	}
}

TEST_CASE("domain: the distance is exact where it rounds to the radius in single precision") {
	// At this width, coordinates are multiples of 2^-7 meters, and 36 offsets between them have a
	// length of exactly 65 / 64. The radius is larger by so little that its square is the same in
	// single precision.
	constexpr double radius = 65.0 / 64.0 * (1.0 + 1e-9);
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			DomainRequest request = request_of({"", {40'000.0, 4.1}, radius, torus}, method.method, 12);
			request.darts_each = 4.0;
			check_guarantees<float>(request, sampled<float>(request));
		}
	}
}

TEST_CASE_TEMPLATE("domain: points are dense up to a border, and a torus has no border", Real, float, double) {
	// An error at a border would first change the number of points next to it. On a torus, a seam
	// has as many points next to it as any other line. The border of a bounded domain has more,
	// because no points lie beyond it.
	constexpr double side = 120.0;
	constexpr double strip = 0.5;
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			std::array<double, 4> edge_counts{};
			double inside = 0.0;
			for (std::uint64_t seed = 11; seed < 15; ++seed) {
				DomainRequest request = request_of({"", {side, side}, 1.0, torus}, method.method, seed);
				request.darts_each = 30.0;
				for (const auto &point : sampled<Real>(request)) {
					edge_counts[0] += point.x < strip;
					edge_counts[1] += point.x >= side - strip;
					edge_counts[2] += point.y < strip;
					edge_counts[3] += point.y >= side - strip;
					inside += point.x >= 0.25 * side && point.x < 0.75 * side;
				}
			}
			const double expected = inside * strip / (0.5 * side);
			for (const double count : edge_counts) {
				CAPTURE(count);
				CAPTURE(expected);
				// About 170 points are expected, with a standard deviation below 10. A border
				// increases the number by 80 %.
				CHECK(std::abs(count / expected - (torus ? 1.0 : 1.8)) < 0.3);
			}
		}
	}
}

TEST_CASE("domain: no square is abandoned in double precision") {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		DomainSampler<double> sampler;
		std::vector<glm::dvec2> points;
		REQUIRE(sampler.sample(request_of({"", {150.0, 150.0}, 1.0, true}, method.method, 9), points).ok());
		CHECK(sampler.stats().discarded == 0);
	}
}

TEST_CASE("domain: no position is left in single precision on a large domain") {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		for (const double side : {300.0, 1100.0}) {
			// A coordinate step is 2^-14 and 2^-12 radii.
			const DomainRequest request = request_of({"", {side, side}, 1.0, true}, method.method, 9);
			check_guarantees<float>(request, sampled<float>(request));
		}
	}
}
