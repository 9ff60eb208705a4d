// Tests the checks that the DomainSampler tests rely on: they must be exact and detect every error.

#include "domain_cases.hpp"

#include "tests/analysis/naive_darts.hpp"

#include <random>

using namespace thicket;
using namespace thicket::domain_cases;
using analysis::compare_distance;
using analysis::compare_distance_exactly;
using analysis::DomainCheck;
using analysis::DomainReport;
using analysis::DomainShape;
using analysis::ExactSum;

namespace {

constexpr glm::dvec2 no_torus(0.0);

int sign_of(std::int64_t value) { return value < 0 ? -1 : value > 0 ? 1 : 0; }

DomainReport report(const std::vector<glm::dvec2> &points, const DomainShape &shape) {
	return DomainCheck::run(std::span<const glm::dvec2>(points), shape, true);
}

/// The domain of the maximal sets that NaiveDarts generates for these tests.
constexpr double reference_side = 20.0;
constexpr DomainShape reference_shape{{reference_side, reference_side}, 1.0, true, 1e-9};

} // namespace

TEST_CASE("domain check: the signs of exact sums are correct") {
	ExactSum sum;
	CHECK(sum.sign() == 0);
	sum.add(1e300);
	sum.add(-0x1p-1000);
	sum.add(-1e300);
	CHECK(sum.sign() == -1);
	sum.add(0x1p-999);
	CHECK(sum.sign() == 1);
	sum.add(-0x1p-1000);
	CHECK(sum.sign() == 0);

	// A double cannot represent (2^27 + 1)^2.
	ExactSum square;
	square.add_product(0x1p27 + 1.0, 0x1p27 + 1.0);
	square.add(-0x1p54 - 0x1p28);
	CHECK(square.sign() == 1);
	square.add(-1.0);
	CHECK(square.sign() == 0);
}

TEST_CASE("domain check: comparisons of distances are exact") {
	// A 3-4-5 triangle so far from the origin that its coordinates have few fractional bits, and
	// the adjacent doubles of each edge.
	const double far_away = 0x1p50;
	CHECK(compare_distance({far_away, 0.0}, {far_away + 3.0, 4.0}, no_torus, 5.0) == 0);
	CHECK(compare_distance({far_away, 0.0}, {far_away + 3.0, std::nextafter(4.0, 0.0)}, no_torus, 5.0) == -1);
	CHECK(compare_distance({far_away, 0.0}, {far_away + 3.0, std::nextafter(4.0, 9.0)}, no_torus, 5.0) == 1);
	CHECK(compare_distance({far_away, 0.0}, {far_away + 3.0, 4.0}, no_torus, std::nextafter(5.0, 9.0)) == -1);
	// A difference that a double cannot represent.
	CHECK(compare_distance({1.0, 0.0}, {-0x1p-80, 0.0}, no_torus, 1.0) == 1);
	CHECK(compare_distance({1.0, 0.0}, {0x1p-80, 0.0}, no_torus, 1.0) == -1);
	CHECK(compare_distance({1.0, 0.0}, {0.0, 0x1p-80}, no_torus, 1.0) == 1);
	CHECK(compare_distance({1.0, 0.0}, {0.0, 0.0}, no_torus, 1.0) == 0);
	// Across the seam of a torus, along each axis. The double 9.9 is slightly more than 9.9.
	CHECK(compare_distance({0.1, 0.0}, {9.9, 0.0}, {10.0, 10.0}, 0.2) == -1);
	CHECK(compare_distance({0.25, 5.0}, {9.5, 5.0}, {10.0, 10.0}, 0.75) == 0);
	CHECK(compare_distance({5.0, 9.5}, {5.0, 0.25}, {10.0, 10.0}, 0.75) == 0);
	CHECK(compare_distance({5.0, 9.5}, {5.0, 0.25}, {10.0, std::nextafter(10.0, 0.0)}, 0.75) == -1);
	CHECK(compare_distance({5.0, 9.5}, {5.0, 0.25}, {10.0, std::nextafter(10.0, 11.0)}, 0.75) == 1);
}

TEST_CASE("domain check: exact comparisons agree with integers") {
	std::mt19937_64 random(1);
	const auto below = [&](std::int64_t count) {
		return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(count));
	};
	constexpr std::int64_t period = (std::int64_t{1} << 52) - 3;
	int ties = 0;
	for (int i = 0; i < 100'000; ++i) {
		// Two points up to about 2^20 apart on each axis, in some cases across a seam, and a radius
		// near their distance.
		const std::int64_t dx = below(1 << 21) - (1 << 20);
		const std::int64_t dy = i % 3 == 0 ? 0 : below(1 << 21) - (1 << 20);
		const std::int64_t x = i % 2 == 0 ? below(period) : below(1 << 19);
		const std::int64_t y = i % 5 == 0 ? period - 1 - below(1 << 19) : below(period);
		const std::int64_t other_x = (x + dx + period) % period;
		const std::int64_t other_y = (y + dy + period) % period;
		const std::int64_t squared = dx * dx + dy * dy;
		const std::int64_t radius = std::llround(std::sqrt(static_cast<double>(squared))) + below(3) - 1;
		const int expected = sign_of(squared - radius * radius);
		ties += expected == 0;
		const glm::dvec2 a(static_cast<double>(x), static_cast<double>(y));
		const glm::dvec2 b(static_cast<double>(other_x), static_cast<double>(other_y));
		const glm::dvec2 torus(static_cast<double>(period));
		const bool right = compare_distance(a, b, torus, static_cast<double>(radius)) == expected &&
				compare_distance_exactly(b, a, torus, static_cast<double>(radius)) == expected;
		REQUIRE(right);
	}
	CHECK(ties > 1000);
}

TEST_CASE("domain check: a valid set passes, on a torus and without its seams") {
	const std::vector<glm::dvec2> points = analysis::NaiveDarts(reference_side, 1).run();
	const DomainReport found_report = report(points, reference_shape);
	CHECK(found_report.points == points.size());
	CHECK(found_report.outside == 0);
	CHECK(found_report.too_close == 0);
	CHECK(found_report.uncovered == 0);
	// On a bounded domain, the same points keep their distance, but no periodic images cover the
	// positions near the border.
	DomainShape bounded = reference_shape;
	bounded.toroidal = false;
	CHECK(report(points, bounded).too_close == 0);
	CHECK(report(points, bounded).uncovered > 0);
}

TEST_CASE("domain check: every single wrong point is detected") {
	const std::vector<glm::dvec2> points = analysis::NaiveDarts(reference_side, 2).run();
	for (std::size_t i = 0; i < points.size(); ++i) {
		std::vector<glm::dvec2> damaged = points;
		damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(i));
		CHECK(report(damaged, reference_shape).uncovered > 0);
		CHECK(report(damaged, reference_shape).too_close == 0);

		damaged.push_back(points[i]);
		damaged.push_back(points[i] + glm::dvec2(0.6, -0.7));
		const auto wrap = [](double position) {
			return position - reference_side * std::floor(position / reference_side);
		};
		damaged.back() = {wrap(damaged.back().x), wrap(damaged.back().y)};
		CHECK(report(damaged, reference_shape).too_close > 0);
		CHECK(report(damaged, reference_shape).uncovered == 0);
	}
}

TEST_CASE("domain check: pairs across each seam and corner of a torus are compared") {
	for (const glm::dvec2 offset :
			{glm::dvec2(0.9, 0.0), glm::dvec2(0.0, 0.9), glm::dvec2(0.6, 0.6), glm::dvec2(0.6, -0.6)}) {
		const DomainShape shape{{9.0, 5.0}, 1.0, true, 1e-9};
		const glm::dvec2 first(0.3, offset.y < 0.0 ? shape.size.y - 0.3 : 0.3);
		const glm::dvec2 second = first - offset;
		const std::vector<glm::dvec2> points = {first,
				{second.x < 0.0 ? second.x + shape.size.x : second.x,
						second.y < 0.0                     ? second.y + shape.size.y
								: second.y >= shape.size.y ? second.y - shape.size.y
														   : second.y}};
		CHECK(report(points, shape).too_close == 1);
		DomainShape bounded = shape;
		bounded.toroidal = false;
		CHECK(report(points, bounded).too_close == 0);
	}
}

TEST_CASE("domain check: bounds are half-open") {
	const DomainShape shape{{2.0, 3.0}, 0.5, false, 1e-9};
	CHECK(report({{0.0, 0.0}, {std::nextafter(2.0, 0.0), std::nextafter(3.0, 0.0)}}, shape).outside == 0);
	CHECK(report({{2.0, 1.0}, {1.0, 3.0}, {-1e-300, 1.0}, {1.0, -1e-300}, {nan(""), 1.0}, {1.0, nan("")}}, shape)
					.outside == 6);
}

TEST_CASE("domain check: gaps are measured against the tolerance") {
	// On a square lattice with spacing `width`, the center of each square of four points is
	// sqrt(1/2) * `width` from all of them, which exceeds a radius of 1 by `excess`.
	constexpr double width = 1.5;
	const double excess = width * std::sqrt(0.5) - 1.0;
	std::vector<glm::dvec2> points;
	for (int y = 0; y < 6; ++y) {
		for (int x = 0; x < 4; ++x) {
			points.emplace_back(width * (x + 0.25), width * (y + 0.75));
		}
	}
	// Counts the gaps for a radius and a tolerance.
	const auto gaps = [&](double radius, double tolerance) {
		return report(points, {{4.0 * width, 6.0 * width}, radius, true, tolerance}).uncovered;
	};
	CHECK(gaps(1.0, 0.03) > 0);
	for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
		CHECK(gaps(1.0 + excess - 1.01 * tolerance, tolerance) > 0);
		CHECK(gaps(1.0 + excess - 0.45 * tolerance, tolerance) == 0);
		CHECK(gaps(1.0 + excess, tolerance) == 0);
	}
}

TEST_CASE("domain check: with a step, exactly the multiples of the step must be covered") {
	// Points on a square lattice, `spacing` steps apart, and the radius that covers everything but the middles of its squares.
	const auto gaps = [](int spacing, double radius, double step) {
		std::vector<glm::dvec2> points;
		for (int y = 0; y < 6; ++y) {
			for (int x = 0; x < 8; ++x) {
				points.emplace_back(spacing * (x + 1), spacing * (y + 1));
			}
		}
		for (glm::dvec2 &r_point : points) {
			r_point = {std::fmod(r_point.x, 8.0 * spacing), std::fmod(r_point.y, 6.0 * spacing)};
		}
		return report(points, {{8.0 * spacing, 6.0 * spacing}, radius, true, 1e-6, step}).uncovered;
	};
	// The middle is a multiple of the step, sqrt(8) steps from four points.
	CHECK(gaps(4, 2.82, 1.0) > 0);
	CHECK(gaps(4, 2.83, 1.0) == 0);
	// The middle is half a step from four multiples, each sqrt(8) steps from its nearest point.
	CHECK(gaps(5, 2.82, 1.0) > 0);
	CHECK(gaps(5, 2.83, 1.0) == 0);
	CHECK(gaps(5, 2.83, 0.5) > 0);
	CHECK(gaps(5, 2.83, 0.0) > 0);
}
