#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/heightfield.hpp"
#include "core/terrain/weight_map.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

using namespace thicket;

namespace {

using Bytes = std::vector<std::uint8_t>;
using Textures = std::vector<std::int32_t>;

const HeightfieldFrame frame{{5, 3}, {{-30.0, 10.0}, {30.0, 70.0}}, 0.0, 100.0};

Bytes random_bytes(std::size_t count, unsigned seed) {
	std::mt19937 random(seed);
	Bytes bytes(count);
	std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
	return bytes;
}

WeightMap map_of(glm::ivec2 size, int channels, const Bytes &bytes) {
	WeightMap map;
	REQUIRE(map.set(size, channels, bytes).ok());
	return map;
}

Heightfield field_with(WeightMap weights) {
	Heightfield field;
	REQUIRE(field.set(frame, std::vector<std::uint16_t>(15, 7)).ok());
	field.set_weights(std::move(weights));
	return field;
}

float weight_at(const Terrain &terrain, glm::dvec2 position, const Textures &textures) {
	Ground ground = terrain.at(position);
	REQUIRE(terrain.weigh({&position, 1}, textures, {&ground, 1}).ok());
	return ground.weight;
}

} // namespace

TEST_CASE("terrain weights: a terrain without weights permits all ground") {
	CHECK(weight_at(FlatTerrain(3.0f), {1.0, 2.0}, {0, 5}) == 1.0f);
	CHECK(weight_at(field_with({}), {0.0, 40.0}, {0}) == 1.0f);
	CHECK(weight_at(field_with({}), {0.0, 40.0}, {77}) == 1.0f);
	CHECK(WeightMap().empty());
}

TEST_CASE("terrain weights: each channel is a texture, at its own pixels, from the first height sample to the last") {
	// 4 x 3 pixels on 60 m x 60 m, so pixels are 20 m and 30 m apart.
	const Bytes bytes = random_bytes(4 * 3 * 4, 1);
	const Heightfield field = field_with(map_of({4, 3}, 4, bytes));
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 4; ++column) {
			const glm::dvec2 position(-30.0 + 20.0 * column, 10.0 + 30.0 * row);
			for (int texture = 0; texture < 4; ++texture) {
				const double byte = bytes[static_cast<std::size_t>((row * 4 + column) * 4 + texture)];
				CHECK(weight_at(field, position, {texture}) == doctest::Approx(byte / 255.0).epsilon(1e-6));
			}
			for (const int texture : {-1, 4, 31, 32, 1 << 30, -(1 << 30)}) {
				CHECK(weight_at(field, position, {texture}) == 0.0f);
			}
		}
	}
}

TEST_CASE(
		"terrain weights: the weights of the requested textures are interpolated bilinearly, added and clamped to 1") {
	const Bytes bytes = random_bytes(4 * 3 * 3, 2);
	const Heightfield field = field_with(map_of({4, 3}, 3, bytes));
	const auto byte = [&](int column, int row, int channel) {
		return static_cast<double>(bytes[static_cast<std::size_t>((row * 4 + column) * 3 + channel)]);
	};
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	int held_count = 0;
	for (int i = 0; i < 2000; ++i) {
		const int column = static_cast<int>(random() % 3);
		const int row = static_cast<int>(random() % 2);
		const double x = unit(random);
		const double y = unit(random);
		std::array<double, 3> weight{};
		for (int channel = 0; channel < 3; ++channel) {
			weight[static_cast<std::size_t>(channel)] =
					((1 - x) * (1 - y) * byte(column, row, channel) + x * (1 - y) * byte(column + 1, row, channel) +
							(1 - x) * y * byte(column, row + 1, channel) + x * y * byte(column + 1, row + 1, channel)) /
					255.0;
		}
		const glm::dvec2 position(-30.0 + 20.0 * (column + x), 10.0 + 30.0 * (row + y));
		CHECK(std::abs(weight_at(field, position, {1}) - weight[1]) < 1e-6);
		CHECK(std::abs(weight_at(field, position, {2, 2, 2, 9}) - weight[2]) <
				1e-6); // A repeated texture is counted once.
		CHECK(std::abs(weight_at(field, position, {2, 0}) - std::min(1.0, weight[0] + weight[2])) < 1e-6);
		CHECK(std::abs(weight_at(field, position, {0, 1, 2}) - std::min(1.0, weight[0] + weight[1] + weight[2])) <
				1e-6);
		held_count += weight[0] + weight[1] + weight[2] > 1.0 ? 1 : 0;
		CHECK(weight_at(field, position, {}) == 0.0f);
	}
	CHECK(held_count > 100);
}

TEST_CASE("terrain weights: weights are exact on the borders and 0 outside, also for a single pixel or row") {
	const Heightfield two = field_with(map_of({2, 1}, 1, {51, 255}));
	CHECK(weight_at(two, {-30.0, 10.0}, {0}) == 0.2f);
	CHECK(weight_at(two, {30.0, 70.0}, {0}) == 1.0f);
	CHECK(weight_at(two, {0.0, 33.0}, {0}) == doctest::Approx(0.6));
	CHECK(weight_at(field_with(map_of({1, 1}, 2, {0, 51})), {12.0, 34.0}, {1}) == 0.2f);
	for (const glm::dvec2 outside : {glm::dvec2(-30.001, 40.0), glm::dvec2(30.001, 40.0), glm::dvec2(0.0, 9.999),
				 glm::dvec2(0.0, 70.001), glm::dvec2(nan_value, 40.0), glm::dvec2(0.0, infinite_value)}) {
		CHECK(weight_at(two, outside, {0}) == 0.0f);
	}
}

TEST_CASE("terrain weights: weights change neither height nor normal, and stay when height samples are replaced") {
	Heightfield field = field_with(map_of({2, 2}, 1, {51, 51, 51, 51}));
	REQUIRE(field.set_meters(frame, std::vector<float>(15, 42.0f)).ok());
	Ground ground = field.at({0.0, 40.0});
	const glm::dvec2 position(0.0, 40.0);
	REQUIRE(field.weigh({&position, 1}, Textures{0}, {&ground, 1}).ok());
	CHECK(ground.height == 42.0f);
	CHECK(ground.normal == glm::vec3(0.0f, 1.0f, 0.0f));
	CHECK(ground.weight == 0.2f);
	field.set_weights({});
	CHECK(weight_at(field, position, {0}) == 1.0f);
}

TEST_CASE("terrain weights: errors name the invalid property and leave the map unchanged") {
	WeightMap map = map_of({1, 1}, 1, {51});
	const auto refuse = [&](glm::ivec2 size, int channels, std::size_t bytes, ErrorCode code, const char *property,
								double value) {
		check_refused(map.set(size, channels, Bytes(bytes)), code, property, value);
		CHECK(map.weight({0.5, 0.5}, 1u) == 0.2f);
	};
	refuse({0, 4}, 1, 0, ErrorCode::out_of_range, "weight_size", 0.0);
	refuse({4, -1}, 1, 4, ErrorCode::out_of_range, "weight_size", -1.0);
	refuse({1 << 16, 1}, 1, 1 << 16, ErrorCode::out_of_range, "weight_size", 1 << 16);
	refuse({2, 2}, 0, 0, ErrorCode::out_of_range, "weight_channels", 0.0);
	refuse({2, 2}, 5, 20, ErrorCode::out_of_range, "weight_channels", 5.0);
	refuse({2, 2}, 3, 11, ErrorCode::wrong_size, "weights", 11.0);
	const Heightfield field = field_with(map);
	std::vector<Ground> ground(2);
	check_refused(field.weigh(std::vector<glm::dvec2>(3), Textures{0}, ground), ErrorCode::wrong_size, "ground", 2.0);
}
