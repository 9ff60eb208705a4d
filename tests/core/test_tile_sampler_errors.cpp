// Tests how TileSampler::sample handles invalid input and its cancel flag, and how it uses memory.

#include "allocation_count.hpp"
#include "core/base/instance_id.hpp"
#include "processor_time.hpp"
#include "tilings.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <limits>
#include <string>

using namespace thicket;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr Rect small_rect{{0.0, 0.0}, {20.0, 20.0}};

/// A sampler and the valid result of an earlier call. A rejected call must leave the result
/// unchanged.
struct Fixture {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	std::vector<SamplePoint> before;

	Fixture() {
		REQUIRE(sampler.sample(PointSet{.seed = 1}, small_rect, points).ok());
		REQUIRE(points.size() > 200);
		before = points;
	}

	/// Checks that a call is rejected with this code and property, does not change the points, and
	/// leaves the sampler usable.
	void refuse(const PointSet &set, const Rect &rect, ErrorCode code, const std::string &property) {
		const Status status = sampler.sample(set, rect, points);
		CHECK(status.code == code);
		CHECK(status.property == property);
		const std::string text = describe(status);
		CAPTURE(text);
		CHECK(text.find(property) != std::string::npos);
		CHECK(points == before);
		std::vector<SamplePoint> repeated;
		REQUIRE(sampler.sample(PointSet{.seed = 1}, small_rect, repeated).ok());
		CHECK(repeated == before);
	}

	void refuse_radius(double radius, ErrorCode code) {
		CAPTURE(radius);
		refuse(PointSet{.seed = 1, .radius = radius}, small_rect, code, "radius");
	}

	void refuse_rect(glm::dvec2 min, glm::dvec2 max, ErrorCode code) {
		CAPTURE(min.x);
		CAPTURE(min.y);
		CAPTURE(max.x);
		CAPTURE(max.y);
		refuse(PointSet{.seed = 1}, {min, max}, code, "rect");
	}
};

} // namespace

TEST_CASE_FIXTURE(Fixture, "sampler errors: radius") {
	refuse_radius(0.0, ErrorCode::not_positive);
	refuse_radius(-0.0, ErrorCode::not_positive);
	refuse_radius(-1.0, ErrorCode::not_positive);
	refuse_radius(nan, ErrorCode::not_finite);
	refuse_radius(inf, ErrorCode::not_finite);
	refuse_radius(-inf, ErrorCode::not_finite);
	refuse_radius(std::nextafter(min_radius, 0.0), ErrorCode::out_of_range);
	refuse_radius(std::numeric_limits<double>::denorm_min(), ErrorCode::out_of_range);
	refuse_radius(std::nextafter(max_radius, inf), ErrorCode::out_of_range);
	refuse_radius(std::numeric_limits<double>::max(), ErrorCode::out_of_range);
}

TEST_CASE_FIXTURE(Fixture, "sampler errors: the message names property and value") {
	const Status status = sampler.sample(PointSet{.seed = 1, .radius = -2.5}, small_rect, points);
	CHECK(describe(status) == "radius must be positive, got -2.5");
	CHECK(status.value == -2.5);
}

TEST_CASE_FIXTURE(Fixture, "sampler errors: levels") {
	refuse(PointSet{.levels = 0}, small_rect, ErrorCode::out_of_range, "levels");
	refuse(PointSet{.levels = max_levels + 1}, small_rect, ErrorCode::out_of_range, "levels");
	refuse(PointSet{.levels = 0xffffffff}, small_rect, ErrorCode::out_of_range, "levels");
}

TEST_CASE_FIXTURE(Fixture, "sampler errors: invalid rectangles") {
	for (const double bad : {nan, inf, -inf}) {
		refuse_rect({bad, 0.0}, {1.0, 1.0}, ErrorCode::not_finite);
		refuse_rect({0.0, bad}, {1.0, 1.0}, ErrorCode::not_finite);
		refuse_rect({0.0, 0.0}, {bad, 1.0}, ErrorCode::not_finite);
		refuse_rect({0.0, 0.0}, {1.0, bad}, ErrorCode::not_finite);
	}
	refuse_rect({1.0, 0.0}, {0.0, 1.0}, ErrorCode::inverted);
	refuse_rect({0.0, 1.0}, {1.0, 0.0}, ErrorCode::inverted);
	refuse_rect({1.0, 1.0}, {0.0, 0.0}, ErrorCode::inverted);
}

TEST_CASE_FIXTURE(Fixture, "sampler errors: rectangles outside of the world") {
	const double limit = lattice_unit(PointSet{}) * 16384.0 * cell_limit;
	refuse_rect({limit - 1.0, 0.0}, {limit + 1.0, 1.0}, ErrorCode::out_of_range);
	refuse_rect({-limit - 1.0, 0.0}, {1.0 - limit, 1.0}, ErrorCode::out_of_range);
	refuse_rect({0.0, limit - 1.0}, {1.0, std::nextafter(limit, inf)}, ErrorCode::out_of_range);
	refuse_rect({0.0, std::nextafter(-limit, -inf)}, {1.0, 1.0 - limit}, ErrorCode::out_of_range);
	refuse_rect({1e300, 1e300}, {1.1e300, 1.1e300}, ErrorCode::out_of_range);
	const double max_double = std::numeric_limits<double>::max();
	refuse_rect({-max_double, -max_double}, {max_double, max_double}, ErrorCode::out_of_range);
}

TEST_CASE_FIXTURE(Fixture, "sampler errors: rectangles with too many points") {
	const double start = test::processor_seconds();
	refuse_rect({0.0, 0.0}, {12'100.0, 12'100.0}, ErrorCode::too_many_points);
	refuse_rect({0.0, 0.0}, {5.0e6, 5.0e6}, ErrorCode::too_many_points);
	refuse(PointSet{.radius = 1e-3}, {{0.0, 0.0}, {20.0, 20.0}}, ErrorCode::too_many_points, "rect");
	refuse(PointSet{.radius = 1e-3, .levels = 8}, {{0.0, 0.0}, {20.0, 20.0}}, ErrorCode::too_many_points, "rect");
	// Calls are rejected before any work. Therefore, ten of them, and as many valid calls by `refuse`, take
	// almost no time.
	CHECK(test::processor_seconds() - start < 5.0);
}

TEST_CASE_FIXTURE(Fixture, "sampler: an empty rectangle returns no points and no error") {
	for (const Rect &rect :
			{Rect{}, Rect{{3.0, 3.0}, {3.0, 9.0}}, Rect{{3.0, 3.0}, {9.0, 3.0}}, Rect{{-7.0, 3.0}, {-7.0, 3.0}}}) {
		points = before;
		CHECK(sampler.sample(PointSet{.seed = 1}, rect, points).ok());
		CHECK(points.empty());
	}
}

TEST_CASE("sampler: sets of extreme radii are similar") {
	// The process is independent of scale: one seed produces the same lattice points for every
	// radius.
	TileSampler sampler;
	std::vector<SamplePoint> unit, other;
	const PointSet unit_set{.seed = 5, .radius = 1.0};
	REQUIRE(sampler.sample(unit_set, {{-10.0, -10.0}, {10.0, 10.0}}, unit).ok());
	for (const double radius : {min_radius, 0x1p-8, 0x1p10, max_radius}) {
		CAPTURE(radius);
		const PointSet set{.seed = 5, .radius = radius};
		REQUIRE(sampler.sample(set, {glm::dvec2(-10.0 * radius), glm::dvec2(10.0 * radius)}, other).ok());
		CHECK(other.size() == unit.size());
		std::size_t differ = 0;
		for (std::size_t i = 0; i < std::min(unit.size(), other.size()); ++i) {
			differ +=
					lattice_position(set, other[i]) != lattice_position(unit_set, unit[i]) || other[i].id != unit[i].id
					? 1
					: 0;
		}
		CHECK(differ == 0);
	}
}

TEST_CASE("sampler: different seeds and layers are different sets") {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	std::vector<std::vector<glm::dvec2>> sets;
	for (const PointSet &set : {PointSet{.seed = 0}, PointSet{.seed = 1}, PointSet{.seed = std::uint64_t{1} << 32},
				 PointSet{.seed = 0, .layer = 1}, PointSet{.seed = 1, .layer = 1}}) {
		REQUIRE(sampler.sample(set, small_rect, points).ok());
		std::vector<glm::dvec2> positions;
		for (const SamplePoint &point : points) {
			positions.push_back(point.position);
		}
		for (const std::vector<glm::dvec2> &previous : sets) {
			std::size_t shared = 0;
			for (const glm::dvec2 position : positions) {
				shared += static_cast<std::size_t>(std::count(previous.begin(), previous.end(), position));
			}
			CHECK(shared == 0);
		}
		sets.push_back(positions);
	}
}

TEST_CASE_FIXTURE(Fixture, "sampler: a raised flag cancels, and the sampler stays usable") {
	std::atomic<bool> cancel{true};
	const double start = test::processor_seconds();
	const Status status = sampler.sample(
			PointSet{.seed = 2}, {{0.0, 0.0}, {10'000.0, 10'000.0}}, points, {.cancel = &cancel, .report = {}});
	CHECK(status.code == ErrorCode::cancelled);
	CHECK(test::processor_seconds() - start < 2.0);
	REQUIRE(sampler.sample(PointSet{.seed = 1}, small_rect, points).ok());
	CHECK(points == before);
	cancel = false;
	REQUIRE(sampler.sample(PointSet{.seed = 1}, small_rect, points, {.cancel = &cancel, .report = {}}).ok());
	CHECK(points == before);
}

TEST_CASE_FIXTURE(Fixture, "sampler: a flag raised during the work cancels soon") {
	for (const std::uint32_t levels : {1u, 8u}) {
		std::atomic<bool> cancel{false};
		Status status;
		std::thread worker([&] {
			// Without cancellation, this takes at least half a minute.
			status = sampler.sample(PointSet{.seed = 3, .levels = levels}, {{0.0, 0.0}, {10'000.0, 10'000.0}}, points,
					{.cancel = &cancel, .report = {}});
		});
		std::this_thread::sleep_for(std::chrono::milliseconds(100));
		const double start = test::processor_seconds();
		cancel = true;
		worker.join();
		// The documented limit is about a millisecond, but builds with sanitizers take longer.
		CHECK(test::processor_seconds() - start < 1.0);
		CHECK(status.code == ErrorCode::cancelled);
		REQUIRE(sampler.sample(PointSet{.seed = 1}, small_rect, points).ok());
		CHECK(points == before);
	}
}

TEST_CASE_FIXTURE(Fixture, "sampler: reports its progress, and can be canceled from a report") {
	const Rect wide{{-300.0, 0.0}, {500.0, 400.0}};
	double last = 0.0;
	std::uint64_t point_count = 0;
	const auto watch = [&](double fraction, std::uint64_t new_count) {
		CHECK(fraction > last);
		CHECK(new_count >= point_count);
		last = fraction;
		point_count = new_count;
	};
	REQUIRE(sampler.sample(PointSet{.seed = 1}, wide, points, {.cancel = nullptr, .report = watch}).ok());
	CHECK(last == 1.0);
	CHECK(point_count == points.size());
	std::atomic<bool> cancel = false;
	const auto stop = [&](double fraction, std::uint64_t) {
		CHECK_FALSE(cancel);
		cancel = fraction > 0.5;
	};
	CHECK(sampler.sample(PointSet{.seed = 1}, wide, points, {.cancel = &cancel, .report = stop}).code ==
			ErrorCode::cancelled);
}

TEST_CASE("sampler: repeated calls allocate nothing") {
	for (const std::uint32_t levels : {1u, 4u}) {
		CAPTURE(levels);
		const PointSet set{.seed = 6, .radius = 1.0, .levels = levels};
		TileSampler sampler;
		std::vector<SamplePoint> points;
		const auto walk = [&] {
			for (int i = 0; i < 60; ++i) {
				const glm::dvec2 corner(40.0 * (i % 10), -1000.0 + 40.0 * (i / 10));
				const Status status = sampler.sample(set, {corner, corner + 40.0}, points);
				if (!status.ok()) {
					return false;
				}
			}
			return true;
		};
		REQUIRE(walk());
		const std::size_t before = allocation_count();
		const bool walked = walk();
		const std::size_t after = allocation_count();
		CHECK(walked);
		CHECK(after == before);
	}
	// Verifies the counter itself. A compiler may remove an unused vector, but not this call.
	const std::size_t before = allocation_count();
	void *const memory = ::operator new(1000);
	CHECK(allocation_count() > before);
	::operator delete(memory);
}

TEST_CASE("sampler: earlier work has no effect on the result") {
	const PointSet set{.seed = 7, .radius = 0.5, .levels = 3, .layer = 2};
	const Rect rect{{100.0, -50.0}, {130.0, -35.0}};
	TileSampler new_sampler;
	std::vector<SamplePoint> expected, points;
	REQUIRE(new_sampler.sample(set, rect, expected).ok());
	TileSampler used;
	std::mt19937_64 random(8);
	for (int i = 0; i < 40; ++i) {
		const PointSet other{.seed = random(),
				.radius = 0.1 + static_cast<double>(random() % 100),
				.levels = 1 + static_cast<std::uint32_t>(random() % max_levels),
				.layer = static_cast<std::uint16_t>(random())};
		const glm::dvec2 corner(static_cast<double>(random() % 1000), static_cast<double>(random() % 1000));
		const glm::dvec2 size(static_cast<double>(random() % 60), static_cast<double>(random() % 60));
		REQUIRE(used.sample(other, {corner * other.radius, (corner + size) * other.radius}, points).ok());
		REQUIRE(used.sample(set, rect, points).ok());
		const bool identical = points == expected;
		CHECK(identical);
	}
	TileSampler moved_sampler = std::move(used);
	REQUIRE(moved_sampler.sample(set, rect, points).ok());
	CHECK(points == expected);
}

TEST_CASE("sampler: the statistics of a call are consistent") {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(PointSet{.seed = 9}, {{0.0, 0.0}, {64.0, 64.0}}, points).ok());
	const SampleStats &stats = sampler.stats();
	CHECK(stats.kept == points.size());
	CHECK(stats.computed >= stats.kept);
	CHECK(stats.darts >= stats.computed);
	CHECK(stats.squares >= stats.cells);
	CHECK(stats.cells >= 8192); // 2 * 64^2 cells, plus the margin.
	CHECK(stats.workspace_bytes > 0);
}
