#include "core/rules/clump_impulses.hpp"
#include "core/rules/clump_noise.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

ClumpNoise noise_of(const Clumping &clumping, std::uint64_t seed = 1) {
	REQUIRE(validate(clumping).ok());
	ClumpNoise noise;
	noise.set(clumping, seed);
	return noise;
}

/// Returns random positions in a square that contains 100,000 clumps of 10 m, away from the origin.
std::vector<glm::dvec2> random_positions(std::size_t count, unsigned seed) {
	std::mt19937_64 random(seed);
	std::uniform_real_distribution<double> along(-4000.0, -4000.0 + 3162.0);
	std::vector<glm::dvec2> result(count);
	std::ranges::generate(result, [&] {
		const double x = along(random);
		return glm::dvec2(x, along(random));
	});
	return result;
}

double mean_at(const ClumpNoise &noise, const std::vector<glm::dvec2> &at) {
	double sum = 0.0;
	for (const glm::dvec2 position : at) {
		sum += noise.at(position);
	}
	return sum / static_cast<double>(at.size());
}

/// With this coverage and softness, the density is a linear function of the noise.
constexpr Clumping plain{.size = 10.0, .coverage = 0.5, .softness = 1.0};

double correlation(const ClumpNoise &noise, const std::vector<glm::dvec2> &at, glm::dvec2 offset) {
	double sum = 0.0;
	for (const glm::dvec2 position : at) {
		sum += (noise.at(position) - 0.5) * (noise.at(position + offset) - 0.5);
	}
	return sum * 12.0 / static_cast<double>(at.size());
}

} // namespace

TEST_CASE("clumps: clumps cover the requested fraction of the plane, for every seed") {
	const auto at = random_positions(40000, 1);
	for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0}}) {
		for (const double coverage : {0.02, 0.1, 0.25, 0.5, 0.75, 0.9, 0.98}) {
			const double fraction = mean_at(noise_of({10.0, coverage, 0.0}, seed), at);
			CAPTURE(coverage);
			CHECK(std::abs(fraction - coverage) < 0.01);
		}
	}
}

TEST_CASE("clumps: soft edges keep the mean and the outline") {
	const auto at = random_positions(40000, 2);
	for (const double coverage : {0.1, 0.25, 0.5, 0.75, 0.9}) {
		const ClumpNoise sharp = noise_of({10.0, coverage, 0.0});
		for (const double softness : {0.1, 0.5, 1.0}) {
			const ClumpNoise soft = noise_of({10.0, coverage, softness});
			CHECK(std::abs(mean_at(soft, at) - coverage) < 0.01);
			for (std::size_t i = 0; i < 1000; ++i) {
				const double density = soft.at(at[i]);
				CHECK((density > 0.5 ? 1.0 : 0.0) == sharp.at(at[i]));
			}
		}
	}
}

TEST_CASE("clumps: the noise is uniform, to half a percent at every twentieth") {
	const auto at = random_positions(200000, 3);
	const ClumpNoise noise = noise_of(plain, 7);
	std::vector<double> values(at.size());
	std::ranges::transform(at, values.begin(), [&](glm::dvec2 position) { return noise.at(position); });
	std::ranges::sort(values);
	for (int twentieth = 1; twentieth < 20; ++twentieth) {
		const double value = values[values.size() * static_cast<std::size_t>(twentieth) / 20];
		CHECK(std::abs(value - twentieth / 20.0) < 0.005);
	}
	CHECK(values.front() >= 0.0);
	CHECK(values.back() <= 1.0);
}

TEST_CASE("clumps: the tables that make the noise uniform match the measured noise") {
	// With 200,000 positions, the standard deviation of a measured fraction is at most 0.0011.
	using Table = std::array<double, clump_knots>;
	constexpr Table plane
#include "core/rules/clump_table.inc"
			;
	constexpr Table space
#include "core/rules/clump_table_space.inc"
			;
	std::vector<double> on_plane;
	std::vector<double> in_space;
	for (const glm::dvec2 position : random_positions(200000, 4)) {
		on_plane.push_back(std::abs(clump_impulses(position, 99)));
		in_space.push_back(std::abs(clump_impulses(glm::dvec3(position, 0.3 * position.x), 99)));
	}
	for (const auto &[nearer, heights] : {std::pair{&plane, &on_plane}, std::pair{&space, &in_space}}) {
		CHECK(std::ranges::is_sorted(*nearer));
		CHECK(nearer->front() == 0.0);
		CHECK(nearer->back() == 1.0);
		std::ranges::sort(*heights);
		for (std::size_t knot = 0; knot < clump_knots; ++knot) {
			const auto below = std::ranges::lower_bound(*heights, static_cast<double>(knot) / clump_knots_per_unit);
			const double fraction =
					static_cast<double>(below - heights->begin()) / static_cast<double>(heights->size());
			CHECK(std::abs(fraction - (*nearer)[knot]) < 0.005);
		}
	}
}

TEST_CASE("clumps: without softness, densities are 0 or 1; coverages of 0 and 1 are exact") {
	const auto at = random_positions(5000, 5);
	for (const double softness : {0.0, 0.3, 1.0}) {
		const ClumpNoise hard = noise_of({10.0, 0.0, softness});
		const ClumpNoise all = noise_of({10.0, 1.0, softness});
		const ClumpNoise clumped = noise_of({10.0, 0.4, softness});
		int soft_count = 0;
		for (const glm::dvec2 position : at) {
			REQUIRE(hard.at(position) == 0.0);
			REQUIRE(all.at(position) == 1.0);
			const double density = clumped.at(position);
			REQUIRE((density >= 0.0 && density <= 1.0));
			soft_count += density > 0.0 && density < 1.0;
		}
		// The edges cover a fraction of 2 * softness * coverage of the plane.
		CHECK(std::abs(soft_count / 5000.0 - 2.0 * softness * 0.4) < 0.03);
	}
}

TEST_CASE("clumps: the centers of clumps are at the requested distance") {
	for (const double size : {1.0, 40.0}) {
		const ClumpNoise noise = noise_of({size, 0.5, 1.0}, 3);
		constexpr int side = 600; // The step is a twelfth of the size, so the square contains 50 by 50 clumps.
		std::vector<double> values(side * side);
		for (int y = 0; y < side; ++y) {
			for (int x = 0; x < side; ++x) {
				values[static_cast<std::size_t>(y * side + x)] = noise.at(glm::dvec2(x, y) * (size / 12.0));
			}
		}
		int maxima = 0;
		for (int y = 1; y + 1 < side; ++y) {
			for (int x = 1; x + 1 < side; ++x) {
				const double *const sample = &values[static_cast<std::size_t>(y * side + x)];
				const double neighbor_max = std::max({sample[-side - 1], sample[-side], sample[-side + 1], sample[-1],
						sample[1], sample[side - 1], sample[side], sample[side + 1]});
				maxima += *sample > neighbor_max;
			}
		}
		CHECK(maxima > 2500 * 0.85);
		CHECK(maxima < 2500 * 1.15);
	}
}

TEST_CASE("clumps: no direction is preferred and no lattice is visible") {
	const auto at = random_positions(60000, 6);
	const ClumpNoise noise = noise_of(plain, 5);
	for (const double distance : {1.5, 3.0, 4.6, 6.9}) { // A noise cell is 4.6 m wide.
		std::vector<double> neighbors;
		for (int direction = 0; direction < 8; ++direction) {
			const double angle = direction * 0.39269908169872414;
			neighbors.push_back(correlation(noise, at, distance * glm::dvec2(std::cos(angle), std::sin(angle))));
		}
		CHECK(std::ranges::max(neighbors) - std::ranges::min(neighbors) < 0.04);
	}
	for (const double distance : {20.0, 100.0, 46.0 * 64.0}) {
		CHECK(std::abs(correlation(noise, at, {distance, 0.0})) < 0.02);
		CHECK(std::abs(correlation(noise, at, {0.0, distance})) < 0.02);
	}
	// Mean and variance over many cells, at each of 8 by 8 positions within a cell.
	constexpr double cell = 10.0 / 2.1747;
	for (int sector = 0; sector < 64; ++sector) {
		double sum = 0.0;
		double squares = 0.0;
		for (int i = 0; i < 2000; ++i) {
			const glm::dvec2 corner(i % 50 * 7, i / 50 * 7);
			const double value = noise.at((corner + glm::dvec2(sector % 8, sector / 8) / 8.0) * cell) - 0.5;
			sum += value;
			squares += value * value;
		}
		CHECK(std::abs(sum / 2000.0) < 0.03);
		CHECK(std::abs(squares / 2000.0 - 1.0 / 12.0) < 0.012);
	}
}

TEST_CASE("clumps: the noise is continuous, near the origin and 10^9 m out, and never repeats") {
	for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(1e9, -1e9), glm::dvec2(-1e9, 5e8)}) {
		const ClumpNoise noise = noise_of(plain, 9);
		double low = 1.0;
		double high = 0.0;
		for (int i = 0; i < 20000; ++i) {
			const glm::dvec2 position = origin + glm::dvec2(i * 0.01, i * -0.007);
			const double value = noise.at(position);
			REQUIRE(std::abs(noise.at(position + glm::dvec2(0.01, -0.007)) - value) < 0.02);
			low = std::min(low, value);
			high = std::max(high, value);
		}
		CHECK(low < 0.1);
		CHECK(high > 0.9);
	}
	// Truncated coordinates would repeat at offsets of 2^n cells.
	const auto at = random_positions(10000, 7);
	for (const double cells : {0x1p8, 0x1p16, 0x1p24, 0x1p32}) {
		CHECK(std::abs(correlation(noise_of(plain, 9), at, {cells * 10.0 / 2.1747, 0.0})) < 0.05);
	}
}

TEST_CASE("clumps: each seed has its own noise, which the size scales") {
	const auto at = random_positions(20000, 8);
	const ClumpNoise first = noise_of(plain, 1);
	const ClumpNoise large = noise_of({20.0, 0.5, 1.0}, 1);
	for (const std::uint64_t seed : {std::uint64_t{2}, std::uint64_t{1} << 40, std::uint64_t{1} + 0x9E3779B97F4A7C15}) {
		const ClumpNoise other = noise_of(plain, seed);
		double sum = 0.0;
		for (const glm::dvec2 position : at) {
			sum += (first.at(position) - 0.5) * (other.at(position) - 0.5);
		}
		CHECK(std::abs(sum * 12.0 / 20000.0) < 0.04);
	}
	for (const glm::dvec2 position : at) {
		REQUIRE(large.at(2.0 * position) == first.at(position));
	}
}

TEST_CASE("clumps: a size of 0 disables clumping, and a position that is not finite has no density") {
	const ClumpNoise disabled = noise_of({});
	CHECK_FALSE(disabled.active());
	CHECK(disabled.at({3.0, 4.0}) == 1.0);
	CHECK_FALSE(ClumpNoise().active());
	CHECK(ClumpNoise().at({-1e300, 0.0}) == 1.0);
	for (const double coverage : {0.0, 0.5, 1.0}) {
		const ClumpNoise noise = noise_of({10.0, coverage, 0.5});
		CHECK(noise.active());
		for (const double bad : {nan_value, infinite_value, -infinite_value, 1e300, -1e300}) {
			CHECK(noise.at({bad, 0.0}) == 0.0);
			CHECK(noise.at({0.0, bad}) == 0.0);
		}
	}
	const ClumpNoise smallest = noise_of({min_clump_size, 0.5, 1.0});
	CHECK(smallest.at({1e9, 1e9}) != smallest.at({1e9 + 0.05, 1e9}));
}

TEST_CASE("clumps: errors name the invalid property") {
	const auto refuse = [](auto change, ErrorCode code, const char *property, double value) {
		Clumping bad{.size = 5.0};
		change(bad);
		check_refused(validate(bad), code, property, value);
	};
	refuse([](auto &bad) { bad.size = nan_value; }, ErrorCode::not_finite, "clump_size", nan_value);
	refuse([](auto &bad) { bad.size = infinite_value; }, ErrorCode::not_finite, "clump_size", infinite_value);
	refuse([](auto &bad) { bad.size = -1.0; }, ErrorCode::out_of_range, "clump_size", -1.0);
	refuse([](auto &bad) { bad.size = 0.05; }, ErrorCode::out_of_range, "clump_size", 0.05);
	refuse([](auto &bad) { bad.size = 2e5; }, ErrorCode::out_of_range, "clump_size", 2e5);
	refuse([](auto &bad) { bad.coverage = -0.1; }, ErrorCode::out_of_range, "clump_coverage", -0.1);
	refuse([](auto &bad) { bad.coverage = 1.1; }, ErrorCode::out_of_range, "clump_coverage", 1.1);
	refuse([](auto &bad) { bad.coverage = nan_value; }, ErrorCode::not_finite, "clump_coverage", nan_value);
	refuse([](auto &bad) { bad.softness = 1.5; }, ErrorCode::out_of_range, "clump_softness", 1.5);
	refuse([](auto &bad) { bad.softness = -0.5; }, ErrorCode::out_of_range, "clump_softness", -0.5);
	refuse([](auto &bad) { bad.softness = -infinite_value; }, ErrorCode::not_finite, "clump_softness", -infinite_value);
	for (const double size : {0.0, min_clump_size, max_clump_size}) {
		CHECK(validate({size, 0.0, 0.0}).ok());
		CHECK(validate({size, 1.0, 1.0}).ok());
	}
}

TEST_CASE("clumps in space: planes of every direction have the same coverage, and values are uniform") {
	const auto at = random_positions(40000, 8);
	const std::array<std::array<glm::dvec3, 2>, 4> planes{{
			{glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 0.0, 1.0)},
			{glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 1.0, 0.0)},
			{glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(0.0, 1.0, 0.0)},
			{glm::dvec3(0.6, 0.8, 0.0), glm::dvec3(0.48, -0.36, 0.8)},
	}};
	for (const auto &plane : planes) {
		const auto on_plane = [&](glm::dvec2 position) {
			return position.x * plane[0] + position.y * plane[1] + glm::dvec3(3.0, 5.0, 7.0);
		};
		for (const double coverage : {0.1, 0.5, 0.9}) {
			const ClumpNoise noise = noise_of({10.0, coverage, 0.0}, 11);
			const auto covered_count =
					std::ranges::count_if(at, [&](glm::dvec2 p) { return noise.at(on_plane(p)) > 0.0; });
			CHECK(std::abs(static_cast<double>(covered_count) / static_cast<double>(at.size()) - coverage) < 0.01);
		}
		const ClumpNoise noise = noise_of(plain, 12);
		std::vector<double> values(at.size());
		std::ranges::transform(at, values.begin(), [&](glm::dvec2 p) { return noise.at(on_plane(p)); });
		std::ranges::sort(values);
		for (int twentieth = 1; twentieth < 20; ++twentieth) {
			const double value = values[values.size() * static_cast<std::size_t>(twentieth) / 20];
			CHECK(std::abs(value - twentieth / 20.0) < 0.012);
		}
	}
}

TEST_CASE("clumps in space: a wall is not striped, and clumps are as large as on the plane") {
	// On a wall, the density changes as much in the vertical direction as sideways, and as much as
	// on the plane.
	const auto at = random_positions(40000, 9);
	const ClumpNoise noise = noise_of(plain, 13);
	const auto on_wall = [](glm::dvec2 position) {
		return glm::dvec3(position.x, position.y, 17.0);
	};
	const auto correlation_of = [&](const glm::dvec3 &offset) {
		double sum = 0.0;
		for (const glm::dvec2 position : at) {
			sum += (noise.at(on_wall(position)) - 0.5) * (noise.at(on_wall(position) + offset) - 0.5);
		}
		return sum * 12.0 / static_cast<double>(at.size());
	};
	for (const double distance : {1.0, 3.0, 5.0}) {
		const double sideways = correlation_of({distance, 0.0, 0.0});
		CHECK(std::abs(correlation_of({0.0, distance, 0.0}) - sideways) < 0.03);
		CHECK(std::abs(correlation_of({0.0, 0.0, distance}) - sideways) < 0.03);
		CHECK(std::abs(correlation(noise, at, {distance, 0.0}) - sideways) < 0.1);
	}
	CHECK(correlation_of({0.0, 30.0, 0.0}) < 0.05);
}

TEST_CASE("clumps in space: invalid and distant positions, and coverages of 0 and 1") {
	const ClumpNoise noise = noise_of(plain, 14);
	CHECK(noise.at(glm::dvec3(0.0, 1e300, 0.0)) == 0.0);
	CHECK(noise.at(glm::dvec3(std::nan(""), 0.0, 0.0)) == 0.0);
	CHECK(noise_of({10.0, 0.0, 0.5}).at(glm::dvec3(1.0)) == 0.0);
	CHECK(noise_of({10.0, 1.0, 0.5}).at(glm::dvec3(1.0)) == 1.0);
	CHECK(noise_of({0.0, 0.5, 0.5}).at(glm::dvec3(1.0)) == 1.0);
}
