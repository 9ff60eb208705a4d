#include "core/sampling/tile_sampler.hpp"
#include "oracle.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>

using namespace thicket;

namespace {

/// Compares the sampler with the oracle on a rectangle of cells.
void check_against_oracle(const PointSet &set, const CellRect &cells) {
	const double cell = lattice_unit(set) * cell_size;
	const Rect rect{glm::dvec2(cells.min) * cell, glm::dvec2(cells.max) * cell};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points).ok());

	std::size_t expected = 0;
	const oracle::Points truth = oracle::points(set, cells);
	for (const auto &[at, point] : truth) {
		expected += cells.contains({at.first, at.second}) ? 1 : 0;
	}
	CHECK(points.size() == expected);
	for (const SamplePoint &point : points) {
		const glm::ivec2 at = unpack(point.id).cell;
		const auto match = truth.find({at.x, at.y});
		REQUIRE(match != truth.end());
		CHECK(match->second.lattice == lattice_position(set, point));
		CHECK(match->second.rank == point.rank);
	}
}

} // namespace

TEST_CASE("oracle: the sampler's points match a strict-time heap") {
	std::mt19937_64 random(20070901);
	for (const std::uint32_t levels : {1u, 2u, 4u}) {
		CAPTURE(levels);
		for (int domain = 0; domain < 20; ++domain) {
			CAPTURE(domain);
			PointSet set;
			set.seed = random();
			set.radius = 0.25 + static_cast<double>(random() % 1000) / 100.0;
			set.levels = levels;
			set.layer = static_cast<std::uint16_t>(random());
			// Half of the domains are near the origin, and the other half anywhere in the world.
			const std::int32_t max_cell = domain % 2 == 0 ? 40 : cell_limit - 400;
			const auto within = [&](std::int32_t bound) {
				return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(2 * bound)) - bound;
			};
			const glm::ivec2 corner(within(max_cell), within(max_cell));
			const glm::ivec2 size(
					1 + static_cast<std::int32_t>(random() % 24), 1 + static_cast<std::int32_t>(random() % 24));
			check_against_oracle(set, {corner, corner + size});
		}
	}
}

TEST_CASE("sampler: a set with a period matches a strict-time heap, and repeats") {
	std::mt19937_64 random(20070902);
	for (const std::uint32_t levels : {1u, 2u, 4u}) {
		for (int domain = 0; domain < 8; ++domain) {
			CAPTURE(levels);
			CAPTURE(domain);
			const std::int32_t step = period_step(levels);
			PointSet set{.seed = random(), .radius = 1.5, .levels = levels, .layer = 3};
			// The smallest periods are narrower than the chains of darts. An axis may have none.
			set.period = glm::ivec2(random() % 7, random() % 7) * step;
			const auto corner = glm::ivec2(random() % 200, random() % 200) - 100;
			const CellRect cells{corner, corner + glm::ivec2(60, 40)};
			const double cell = lattice_unit(set) * cell_size;
			TileSampler sampler;
			std::vector<SamplePoint> points;
			REQUIRE(sampler.sample(set, {glm::dvec2(cells.min) * cell, glm::dvec2(cells.max) * cell}, points).ok());

			const oracle::Points truth = oracle::points(set, cells);
			const auto expected = std::ranges::count_if(
					truth, [&](const auto &each) { return cells.contains({each.first.first, each.first.second}); });
			CHECK(static_cast<std::int64_t>(points.size()) == expected);
			std::map<std::uint64_t, glm::i64vec2> in_period;
			for (const SamplePoint &point : points) {
				const glm::i64vec2 lattice = lattice_position(set, point);
				const glm::ivec2 at(lattice >> std::int64_t{lattice_bits});
				const auto match = truth.find({at.x, at.y});
				REQUIRE(match != truth.end());
				CHECK(match->second.lattice == lattice);
				CHECK(match->second.rank == point.rank);
				const glm::ivec2 first(wrapped(at.x, set.period.x), wrapped(at.y, set.period.y));
				CHECK(point.id == pack({set.layer, first}));
				const glm::i64vec2 shifted = lattice - glm::i64vec2(at - first) * std::int64_t{cell_size};
				CHECK(in_period.try_emplace(point.id, shifted).first->second == shifted);
			}
		}
	}
}

TEST_CASE("sampler: a period that does not fit the levels is rejected") {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	for (const glm::ivec2 period : {glm::ivec2(10, 7), glm::ivec2(-10, 0), glm::ivec2(10, cell_limit + 10)}) {
		PointSet set{.radius = 1.0, .levels = 2};
		set.period = period;
		const Status status = sampler.sample(set, {{0.0, 0.0}, {9.0, 9.0}}, points);
		CHECK(status.code == ErrorCode::out_of_range);
		CHECK(std::string(status.property) == "period");
	}
	PointSet set{.radius = 1.0, .levels = 2};
	set.period = {10, 0};
	CHECK(sampler.sample(set, {{0.0, 0.0}, {9.0, 9.0}}, points).ok());
}

namespace {

/// Returns the number of computed points per returned point, in tiles that are 64 radii wide, over
/// a dozen sets.
double computed_for_one(std::uint32_t levels) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	double computed = 0.0;
	double kept_count = 0.0;
	for (int tile = 0; tile < 12; ++tile) {
		const PointSet set{.seed = static_cast<std::uint64_t>(tile), .radius = 1.0, .levels = levels, .layer = 1};
		REQUIRE(sampler.sample(set, {{0.0, 0.0}, {64.0, 64.0}}, points).ok());
		computed += static_cast<double>(sampler.stats().computed);
		kept_count += static_cast<double>(sampler.stats().kept);
	}
	return computed / kept_count;
}

} // namespace

TEST_CASE("sampler: early darts around a window, and coarser levels, are decided for cells before any request") {
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		// The measured ratio is 1.16. It would be 1.12 if darts were decided only on request.
		CHECK(computed_for_one(1) > 1.14);
		// The measured ratio is 1.39. It would be 1.32 without the early darts, and 1.28 if coarser
		// levels were decided only on request, too.
		CHECK(computed_for_one(4) > 1.35);
	}
}

TEST_CASE("sampler: the first darts of a wide margin are thrown only where a chain needs one") {
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		TileSampler sampler;
		std::vector<SamplePoint> points;
		int untouched = 0;
		for (std::uint64_t seed = 0; seed < 600; ++seed) {
			REQUIRE(sampler.sample({.seed = seed}, {{0.0, 0.0}, {4.0, 4.0}}, points).ok());
			// Every cell whose first dart is thrown counts as a square.
			untouched += sampler.stats().squares < sampler.stats().cells ? 1 : 0;
		}
		CHECK(untouched > 500); // The measured number is 598.
		CHECK(untouched < 600);
	}
}

TEST_CASE("sampler: darts are decided in vectors, and early ones first, which saves most of the later ones") {
	const PointSet set{.seed = 7, .radius = 1.0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	CHECK(bench::runs_vectors([&] { REQUIRE(sampler.sample(set, {{0.0, 0.0}, {64.0, 64.0}}, points).ok()); }));
	// The measured numbers per point are 5.1 darts and 11.8 squares. With all darts in one pass,
	// they would be 9.2 darts and 18.7 squares.
	const auto kept_count = static_cast<double>(sampler.stats().kept);
	CHECK(static_cast<double>(sampler.stats().darts) < 7.0 * kept_count);
	CHECK(static_cast<double>(sampler.stats().squares) < 15.0 * kept_count);
}
