#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/heightfield.hpp"
#include "refusal.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

using namespace thicket;

namespace {

/// The frame of a field with 7 columns and 4 rows, neither square nor at the origin, with a
/// different spacing on each axis.
const HeightfieldFrame frame{{7, 4}, {{-30.0, 10.0}, {30.0, 70.0}}, -100.0, 1210.7};
constexpr double step = (1210.7 + 100.0) / 65535.0;

std::vector<std::uint16_t> random_posts(glm::ivec2 posts, unsigned seed) {
	std::mt19937 random(seed);
	std::vector<std::uint16_t> values(static_cast<std::size_t>(posts.x) * static_cast<std::size_t>(posts.y));
	std::ranges::generate(values, [&] { return static_cast<std::uint16_t>(random()); });
	return values;
}

Heightfield field_of(const HeightfieldFrame &field_frame, const std::vector<std::uint16_t> &posts) {
	Heightfield field;
	REQUIRE(field.set(field_frame, posts).ok());
	return field;
}

bool same_bits(const Ground &a, const Ground &b) { return std::memcmp(&a, &b, sizeof(Ground)) == 0; }

} // namespace

TEST_CASE("terrain: flat ground is the same everywhere, and missing at infinity") {
	const FlatTerrain flat(12.5f);
	for (const glm::dvec2 position : {glm::dvec2(0.0), glm::dvec2(-1e7, 5e6)}) {
		CHECK(flat.at(position).height == 12.5f);
		CHECK(flat.at(position).normal == glm::vec3(0.0f, 1.0f, 0.0f));
	}
	CHECK(std::isnan(flat.at({nan_value, 0.0}).height));
	CHECK(std::isnan(flat.at({0.0, infinite_value}).height));

	const std::vector<glm::dvec2> positions(3);
	std::vector<Ground> ground(2);
	check_refused(flat.sample(positions, ground), ErrorCode::wrong_size, "ground", 2.0);
}

TEST_CASE("terrain: a heightfield returns each sample at its position, including borders") {
	const auto posts = random_posts(frame.posts, 1);
	const Heightfield field = field_of(frame, posts);
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			const glm::dvec2 position(-30.0 + column * 10.0, 10.0 + row * 20.0);
			const double expected = -100.0 + posts[static_cast<std::size_t>(row * frame.posts.x + column)] * step;
			CHECK(field.at(position).height == doctest::Approx(expected).epsilon(1e-6));
		}
	}
}

TEST_CASE("terrain: heights are bilinear between samples") {
	const auto posts = random_posts(frame.posts, 2);
	const Heightfield field = field_of(frame, posts);
	const auto height = [&](int column, int row) {
		return -100.0 + posts[static_cast<std::size_t>(row * frame.posts.x + column)] * step;
	};
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int i = 0; i < 1000; ++i) {
		const int column = static_cast<int>(random() % 6);
		const int row = static_cast<int>(random() % 3);
		const double x = unit(random);
		const double y = unit(random);
		const double expected = (1 - x) * (1 - y) * height(column, row) + x * (1 - y) * height(column + 1, row) +
				(1 - x) * y * height(column, row + 1) + x * y * height(column + 1, row + 1);
		const Ground ground = field.at({-30.0 + (column + x) * 10.0, 10.0 + (row + y) * 20.0});
		CHECK(std::abs(ground.height - expected) < 1e-3);
	}
}

TEST_CASE("terrain: an inclined plane has its true height and normal everywhere, including borders") {
	// Heights rise by 37 steps per column of 10 m and by 120 steps per row of 20 m.
	std::vector<std::uint16_t> posts;
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			posts.push_back(static_cast<std::uint16_t>(1000 + 37 * column + 120 * row));
		}
	}
	const Heightfield field = field_of(frame, posts);
	const glm::dvec2 gradient(37 * step / 10.0, 120 * step / 20.0);
	const glm::dvec3 normal = glm::normalize(glm::dvec3(-gradient.x, 1.0, -gradient.y));
	for (double y = 10.0; y <= 70.0; y += 1.25) {
		for (double x = -30.0; x <= 30.0; x += 1.25) {
			const Ground ground = field.at({x, y});
			const double expected = -100.0 + 1000 * step + gradient.x * (x + 30.0) + gradient.y * (y - 10.0);
			CHECK(std::abs(ground.height - expected) < 1e-4);
			CHECK(glm::distance(glm::dvec3(ground.normal), normal) < 1e-6);
		}
	}
}

TEST_CASE("terrain: normals have unit length, point up and have no seam along the samples") {
	const Heightfield field = field_of(frame, random_posts(frame.posts, 4));
	constexpr double tolerance = 1e-7;
	for (double z = 10.5; z < 70.0; z += 0.5) {
		for (const double line : {-20.0, -10.0, 0.0, 20.0}) {
			const Ground before = field.at({line - tolerance, z});
			const Ground beyond_line = field.at({line + tolerance, z});
			CHECK(glm::distance(before.normal, beyond_line.normal) < 1e-4f);
			CHECK(before.normal.y > 0.0f);
			CHECK(glm::length(before.normal) == doctest::Approx(1.0).epsilon(1e-6));
		}
	}
	for (double z = -29.5; z < 30.0; z += 0.5) {
		CHECK(glm::distance(field.at({z, 30.0 - tolerance}).normal, field.at({z, 30.0 + tolerance}).normal) < 1e-4f);
	}
}

TEST_CASE("terrain: the steepest allowed field still has normals") {
	const Heightfield field = field_of({{2, 2}, {{0.0, 0.0}, {0.001, 0.001}}, -1e6, 1e6}, {0, 65535, 65535, 0});
	for (const glm::dvec2 position :
			{glm::dvec2(0.0), glm::dvec2(0.0005), glm::dvec2(0.001), glm::dvec2(0.0003, 0.0008)}) {
		const Ground ground = field.at(position);
		CHECK(glm::length(ground.normal) == doctest::Approx(1.0).epsilon(1e-6));
		CHECK(ground.normal.y > 0.0f);
		CHECK(std::abs(ground.height) <= 1e6f);
	}
}

TEST_CASE("terrain: the normal at a sample matches the central differences") {
	const auto posts = random_posts(frame.posts, 5);
	const Heightfield field = field_of(frame, posts);
	const auto height = [&](int column, int row) {
		return posts[static_cast<std::size_t>(row * frame.posts.x + column)] * step;
	};
	const double x = (height(4, 2) - height(2, 2)) / 20.0;
	const double y = (height(3, 3) - height(3, 1)) / 40.0;
	const glm::dvec3 expected = glm::normalize(glm::dvec3(-x, 1.0, -y));
	CHECK(glm::distance(glm::dvec3(field.at({0.0, 50.0}).normal), expected) < 1e-6);
}

TEST_CASE("terrain: outside a heightfield there is no ground") {
	const Heightfield field = field_of(frame, random_posts(frame.posts, 6));
	for (const glm::dvec2 position : {glm::dvec2(-30.001, 40.0), glm::dvec2(30.001, 40.0), glm::dvec2(0.0, 9.999),
				 glm::dvec2(0.0, 70.001), glm::dvec2(nan_value, 40.0), glm::dvec2(0.0, nan_value),
				 glm::dvec2(infinite_value, 40.0), glm::dvec2(0.0, -infinite_value), glm::dvec2(1e300, 40.0)}) {
		CAPTURE(position.x);
		CAPTURE(position.y);
		CHECK(std::isnan(field.at(position).height));
	}
	CHECK(std::isnan(Heightfield().at({0.0, 0.0}).height));
}

TEST_CASE("terrain: a position is bit-identical in any batch") {
	const Heightfield field = field_of(frame, random_posts(frame.posts, 7));
	std::mt19937 random(8);
	std::uniform_real_distribution<double> along(-35.0, 75.0);
	std::vector<glm::dvec2> positions(1000);
	std::ranges::generate(positions, [&] { return glm::dvec2(along(random), along(random)); });
	std::vector<Ground> forward_order(positions.size());
	REQUIRE(field.sample(positions, forward_order).ok());
	std::ranges::reverse(positions);
	std::vector<Ground> back(positions.size());
	REQUIRE(field.sample(positions, back).ok());
	for (std::size_t i = 0; i < positions.size(); ++i) {
		CHECK(same_bits(back[i], forward_order[positions.size() - 1 - i]));
		CHECK(same_bits(back[i], field.at(positions[i])));
	}
}

TEST_CASE("terrain: a field 5,000 km out is as exact as one at the origin") {
	const auto posts = random_posts(frame.posts, 9);
	const glm::dvec2 offset(5e6, -5e6);
	HeightfieldFrame distant = frame;
	distant.area = {frame.area.min + offset, frame.area.max + offset};
	const Heightfield near_field = field_of(frame, posts);
	const Heightfield far_field = field_of(distant, posts);
	for (double z = -29.0; z < 30.0; z += 0.37) {
		const glm::dvec2 position(z, z + 40.0);
		const Ground a = near_field.at(position);
		const Ground b = far_field.at(position + offset);
		CHECK(std::abs(a.height - b.height) < 1e-3f);
		CHECK(glm::distance(a.normal, b.normal) < 1e-5f);
	}
}

TEST_CASE("terrain: errors name the invalid property and leave the heightfield unchanged") {
	const auto posts = random_posts(frame.posts, 10);
	Heightfield field = field_of(frame, posts);
	const Ground before = field.at({3.0, 33.0});
	const auto refuse = [&](auto change, ErrorCode code, const char *property, double value) {
		HeightfieldFrame bad = frame;
		change(bad);
		check_refused(field.set(bad, posts), code, property, value);
		CHECK(same_bits(field.at({3.0, 33.0}), before));
	};
	refuse([](auto &bad) { bad.posts = {0, 0}; }, ErrorCode::out_of_range, "posts", 0.0);
	refuse([](auto &bad) { bad.posts = {1, 28}; }, ErrorCode::out_of_range, "posts", 1.0);
	refuse([](auto &bad) { bad.posts = {28, 1}; }, ErrorCode::out_of_range, "posts", 1.0);
	refuse([](auto &bad) { bad.posts = {-7, -4}; }, ErrorCode::out_of_range, "posts", -7.0);
	refuse([](auto &bad) { bad.posts = {1 << 30, 4}; }, ErrorCode::out_of_range, "posts", 1 << 30);
	refuse([](auto &bad) { bad.posts = {7, 5}; }, ErrorCode::wrong_size, "posts", 28.0);
	refuse([](auto &bad) { bad.area.max.x = -30.0; }, ErrorCode::not_positive, "area", 0.0);
	refuse([](auto &bad) { bad.area.max.y = 9.0; }, ErrorCode::not_positive, "area", -1.0);
	refuse([](auto &bad) { bad.area = {{0.0, 10.0}, {0.003, 70.0}}; }, ErrorCode::out_of_range, "area", 0.003);
	refuse([](auto &bad) { bad.area.min.x = nan_value; }, ErrorCode::not_finite, "area", nan_value);
	refuse([](auto &bad) { bad.area.max.x = infinite_value; }, ErrorCode::not_finite, "area", infinite_value);
	refuse([](auto &bad) { bad.area.min.y = -infinite_value; }, ErrorCode::not_finite, "area", infinite_value);
	refuse([](auto &bad) { bad.area.min.y = bad.area.max.y = infinite_value; }, ErrorCode::not_finite, "area",
			nan_value);
	refuse([](auto &bad) { bad.min_height = nan_value; }, ErrorCode::not_finite, "min_height", nan_value);
	refuse([](auto &bad) { bad.max_height = infinite_value; }, ErrorCode::not_finite, "max_height", infinite_value);
	refuse([](auto &bad) { bad.max_height = -101.0; }, ErrorCode::inverted, "max_height", -101.0);
	refuse([](auto &bad) { bad.max_height = 2e6; }, ErrorCode::out_of_range, "max_height", 2e6);
	check_refused(field.set(frame, {}), ErrorCode::wrong_size, "posts", 0.0);
	std::vector<Ground> ground(2);
	check_refused(field.sample(std::vector<glm::dvec2>(3), ground), ErrorCode::wrong_size, "ground", 2.0);
}

TEST_CASE("terrain: patches computed together are bit-identical to those computed alone") {
	// With heights from 0 to 65535 m, the value of a sample is its height in meters. Therefore, the same
	// field in meters, whose patches are computed one by one, must be identical.
	const HeightfieldFrame frame{{23, 19}, {{-31.0, 7.0}, {100.0, 90.0}}, 0.0, 65535.0};
	std::mt19937 random(11);
	std::vector<std::uint16_t> steps;
	std::vector<float> meters;
	for (int i = 0; i < 23 * 19; ++i) {
		steps.push_back(static_cast<std::uint16_t>(random() % 4000));
		meters.push_back(static_cast<float>(steps.back()));
	}
	Heightfield joined_field;
	Heightfield alone;
	REQUIRE(joined_field.set(frame, steps).ok());
	REQUIRE(alone.set_meters(frame, meters).ok());
	std::uniform_real_distribution<double> x(-40.0, 110.0);
	std::uniform_real_distribution<double> y(0.0, 95.0);
	for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{33}, std::size_t{5000}}) {
		std::vector<glm::dvec2> positions(count);
		for (glm::dvec2 &position : positions) {
			position = {x(random), y(random)};
		}
		std::vector<Ground> actual(count);
		std::vector<Ground> expected(count);
		REQUIRE(joined_field.sample(positions, actual).ok());
		REQUIRE(alone.sample(positions, expected).ok());
		for (std::size_t i = 0; i < count; ++i) {
			REQUIRE(std::isnan(actual[i].height) == std::isnan(expected[i].height));
			REQUIRE((std::isnan(actual[i].height) || actual[i].height == expected[i].height));
			REQUIRE(actual[i].normal == expected[i].normal);
		}
	}
}

TEST_CASE("terrain: patches away from the border are computed in vectors, even a few") {
	const HeightfieldFrame frame{{6, 5}, {{0.0, 0.0}, {5.0, 4.0}}, 0.0, 100.0};
	Heightfield field;
	REQUIRE(field.set(frame, std::vector<std::uint16_t>(30, 7)).ok());
	const auto by_vectors = [&](const std::vector<glm::dvec2> &positions) {
		std::vector<Ground> ground(positions.size());
		return bench::runs_vectors([&] { REQUIRE(field.sample(positions, ground).ok()); });
	};
	CHECK(by_vectors({{2.5, 1.5}}));
	CHECK(by_vectors({{0.5, 0.5}, {-9.0, 0.0}, {1.0, 2.9}}));
	CHECK(by_vectors(std::vector<glm::dvec2>(100, {3.25, 2.0})));
	// All these positions are at the border or outside.
	CHECK_FALSE(by_vectors({{0.5, 1.5}, {4.5, 1.5}, {2.5, 3.5}, {-9.0, 0.0}}));
}
