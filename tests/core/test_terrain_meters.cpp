#include "core/terrain/heightfield.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;

namespace {

/// A frame that is neither square nor at the origin, with a spacing of 10 m along x and 20 m along
/// z.
const HeightfieldFrame frame{{7, 4}, {{-30.0, 10.0}, {30.0, 70.0}}, -100.0, 1210.7};

constexpr float missing = std::numeric_limits<float>::quiet_NaN();

std::size_t index_of(int column, int row) { return static_cast<std::size_t>(row * frame.posts.x + column); }

glm::dvec2 position_at(double column, double row) { return {-30.0 + 10.0 * column, 10.0 + 20.0 * row}; }

std::vector<float> random_meters(unsigned seed) {
	std::mt19937 random(seed);
	std::uniform_real_distribution<float> height(-500.0f, 3000.0f);
	std::vector<float> posts(index_of(0, frame.posts.y));
	std::ranges::generate(posts, [&] { return height(random); });
	return posts;
}

Heightfield field_of(const std::vector<float> &posts) {
	Heightfield field;
	REQUIRE(field.set_meters(frame, posts).ok());
	return field;
}

bool same_bits(const Ground &a, const Ground &b) { return std::memcmp(&a, &b, sizeof(Ground)) == 0; }

} // namespace

TEST_CASE("terrain: samples in meters keep their height, regardless of the frame's height range") {
	const auto posts = random_meters(1);
	HeightfieldFrame other = frame;
	other.min_height = other.max_height = 5.0;
	Heightfield field;
	REQUIRE(field.set_meters(other, posts).ok());
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			CHECK(field.at(position_at(column, row)).height == posts[index_of(column, row)]);
		}
	}
	// A height that is finer than 16-bit samples can represent.
	const Heightfield fine = field_of(std::vector<float>(28, 1000.0001f));
	CHECK(fine.at({0.0, 40.0}).height == 1000.0001f);
}

TEST_CASE("terrain: 16-bit samples and samples in meters with equal heights are the same ground") {
	HeightfieldFrame whole_steps = frame; // One step is 1 m, so that both fields have the same numbers.
	whole_steps.min_height = 0.0;
	whole_steps.max_height = 65535.0;
	std::mt19937 random(2);
	std::vector<std::uint16_t> steps(index_of(0, frame.posts.y));
	std::ranges::generate(steps, [&] { return static_cast<std::uint16_t>(random()); });
	Heightfield coarse;
	REQUIRE(coarse.set(whole_steps, steps).ok());
	const Heightfield fine = field_of({steps.begin(), steps.end()});
	for (double x = -31.0; x < 32.0; x += 0.7) {
		for (double z = 9.0; z < 72.0; z += 0.7) {
			CHECK(same_bits(coarse.at({x, z}), fine.at({x, z})));
		}
	}
	// Setting samples of one kind replaces samples of the other kind.
	Heightfield meters = field_of(random_meters(4));
	REQUIRE(meters.set(frame, steps).ok());
	CHECK(meters.at(position_at(2, 1)).height == doctest::Approx(-100.0 + steps[index_of(2, 1)] * 1310.7 / 65535.0));
	REQUIRE(meters.set_meters(frame, random_meters(3)).ok());
	CHECK(meters.at(position_at(2, 1)).height == random_meters(3)[index_of(2, 1)]);
}

TEST_CASE("terrain: there is no ground between four samples only if one of them is missing") {
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			auto posts = random_meters(4);
			posts[index_of(column, row)] = missing;
			const Heightfield field = field_of(posts);
			for (double x = 0.05; x < 6.0; x += 0.1) {
				for (double z = 0.05; z < 3.0; z += 0.1) {
					const bool is_adjacent = std::abs(x - column) < 1.0 && std::abs(z - row) < 1.0;
					const Ground ground = field.at(position_at(x, z));
					CHECK(std::isnan(ground.height) == is_adjacent);
					CHECK(std::abs(glm::length(ground.normal) - 1.0f) < 1e-5f);
					CHECK(ground.normal.y > 0.0f);
				}
			}
		}
	}
	CHECK(std::isnan(field_of(std::vector<float>(28, missing)).at({0.0, 40.0}).height));
}

TEST_CASE("terrain: ground on the line between a patch and a hole belongs to the patch with the larger x and z") {
	auto posts = random_meters(5);
	posts[index_of(3, 1)] = missing; // The hole removes patches 2 and 3 of rows 0 and 1.
	const Heightfield field = field_of(posts);
	CHECK(std::isnan(field.at(position_at(2.0, 0.5)).height));
	CHECK(!std::isnan(field.at(position_at(4.0, 0.5)).height));
	CHECK(!std::isnan(field.at(position_at(3.0, 2.0)).height));
	CHECK(std::isnan(field.at(position_at(2.5, 0.0)).height));
}

TEST_CASE("terrain: an inclined plane with holes keeps its height and its normal up to their borders") {
	std::vector<float> posts;
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			posts.push_back(static_cast<float>(100 + 8 * column - 12 * row));
		}
	}
	posts[index_of(2, 1)] = posts[index_of(5, 2)] = posts[index_of(0, 3)] = missing;
	const Heightfield field = field_of(posts);
	const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.8, 1.0, 0.6));
	int positions = 0;
	for (double x = 0.0; x <= 6.0; x += 0.125) {
		for (double z = 0.0; z <= 3.0; z += 0.125) {
			const Ground ground = field.at(position_at(x, z));
			if (!std::isnan(ground.height)) {
				++positions;
				CHECK(std::abs(ground.height - (100.0 + 8.0 * x - 12.0 * z)) < 1e-4);
				CHECK(glm::distance(glm::dvec3(ground.normal), normal) < 1e-6);
			}
		}
	}
	CHECK(positions > 400);
}

TEST_CASE("terrain: normals next to a hole have no seam between the remaining patches") {
	auto posts = random_meters(6);
	posts[index_of(3, 1)] = missing;
	const Heightfield field = field_of(posts);
	constexpr double tolerance = 1e-9;
	for (double x = 0.01; x < 2.0;
			x += 0.1) { // The patches of columns 4 and 5 in rows 0 to 2 share samples at the edge of the hole.
		const glm::vec3 before = field.at(position_at(5.0 - tolerance, x)).normal;
		CHECK(glm::distance(before, field.at(position_at(5.0 + tolerance, x)).normal) < 1e-4f);
	}
	for (double x = 4.01; x < 6.0; x += 0.1) {
		const glm::vec3 before = field.at(position_at(x, 1.0 - tolerance)).normal;
		CHECK(glm::distance(before, field.at(position_at(x, 1.0 + tolerance)).normal) < 1e-4f);
	}
}

TEST_CASE("terrain: errors name the invalid samples in meters and leave the field unchanged") {
	const auto posts = random_meters(7);
	Heightfield field = field_of(posts);
	const Ground before = field.at({3.0, 33.0});
	const auto refuse = [&](float post, ErrorCode code) {
		auto bad = posts;
		bad[13] = post;
		check_refused(field.set_meters(frame, bad), code, "posts", post);
		CHECK(same_bits(field.at({3.0, 33.0}), before));
	};
	refuse(std::numeric_limits<float>::infinity(), ErrorCode::not_finite);
	refuse(-std::numeric_limits<float>::infinity(), ErrorCode::not_finite);
	refuse(1.1e6f, ErrorCode::out_of_range);
	refuse(-1.1e6f, ErrorCode::out_of_range);
	check_refused(field.set_meters(frame, std::vector<float>(27)), ErrorCode::wrong_size, "posts", 27.0);
	HeightfieldFrame bad = frame;
	bad.area.max.x = nan_value;
	check_refused(field.set_meters(bad, posts), ErrorCode::not_finite, "area", nan_value);
	CHECK(same_bits(field.at({3.0, 33.0}), before));
}
