#include "core/terrain/heightfield.hpp"
#include "core/terrain/map_field.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;

namespace {

constexpr int posts = 33;

using Bytes = std::vector<std::uint8_t>;

/// Returns a square image. `write` is called once for each pixel to fill its bytes.
PixelGrid grid_of(int pixel_bytes, const std::function<void(glm::ivec2, std::uint8_t *)> &write, int side = posts) {
	auto bytes = std::make_shared<Bytes>(static_cast<std::size_t>(side) * side * pixel_bytes);
	std::uint8_t *pixel = bytes->data();
	for (int row = 0; row < side; ++row) {
		for (int column = 0; column < side; ++column, pixel += pixel_bytes) {
			write({column, row}, pixel);
		}
	}
	PixelGrid grid;
	REQUIRE(grid.set(glm::ivec2(side), pixel_bytes, {bytes, *bytes}).ok());
	return grid;
}

float post_at(glm::ivec2 post) {
	return 4.0F * std::sin(0.3F * static_cast<float>(post.x)) + 0.125F * static_cast<float>(post.y);
}

PixelGrid float_heights(const std::function<float(glm::ivec2)> &height = post_at) {
	return grid_of(4, [&](glm::ivec2 post, std::uint8_t *pixel) {
		const float value = height(post);
		std::memcpy(pixel, &value, 4);
	});
}

MapField field_of(const MapTransform &transform, const MapLayers &layers) {
	MapField field;
	const Status status = field.set(transform, layers);
	INFO(describe(status));
	REQUIRE(status.ok());
	return field;
}

MapLayers plain_layers() {
	MapLayers layers;
	layers.heights = float_heights();
	return layers;
}

float weight(const MapField &field, glm::dvec2 position, std::vector<std::int32_t> textures) {
	Ground ground;
	REQUIRE(field.weigh({&position, 1}, textures, {&ground, 1}).ok());
	return ground.weight;
}

PixelGrid bytes_grid(const std::function<std::array<int, 4>(glm::ivec2)> &value, int pixel_bytes) {
	return grid_of(pixel_bytes, [&](glm::ivec2 post, std::uint8_t *pixel) {
		const std::array<int, 4> channels = value(post);
		std::copy_n(channels.begin(), pixel_bytes, pixel);
	});
}

} // namespace

TEST_CASE("map field: the surface equals the surface of a heightfield with the same samples") {
	std::vector<float> meters;
	for (int row = 0; row < posts; ++row) {
		for (int column = 0; column < posts; ++column) {
			meters.push_back(post_at({column, row}));
		}
	}
	Heightfield expected;
	REQUIRE(expected.set_meters({glm::ivec2(posts), {{-32.0, 10.0}, {32.0, 138.0}}}, meters).ok());
	MapTransform transform;
	transform.to_world = glm::dmat2(2.0, 0.0, 0.0, 4.0);
	transform.origin = {-32.0, 0.0, 10.0};
	const MapField field = field_of(transform, plain_layers());
	std::mt19937 random(1);
	std::uniform_real_distribution<double> x(-40.0, 40.0);
	std::uniform_real_distribution<double> z(0.0, 150.0);
	for (int i = 0; i < 10000; ++i) {
		const glm::dvec2 at{x(random), z(random)};
		const Ground a = expected.at(at);
		const Ground b = field.at(at);
		REQUIRE(std::isnan(a.height) == std::isnan(b.height));
		if (!std::isnan(a.height)) {
			REQUIRE(std::abs(a.height - b.height) < 1e-5F);
			REQUIRE(glm::distance(a.normal, b.normal) < 1e-5F);
		}
	}
	for (const glm::dvec2 corner : {glm::dvec2(-32.0, 10.0), glm::dvec2(32.0, 138.0)}) {
		CHECK_FALSE(std::isnan(field.at(corner).height)); // The field includes its border.
	}
	CHECK(std::isnan(field.at({std::nan(""), 20.0}).height));
}

TEST_CASE("map field: maps can be rotated, scaled and moved") {
	MapTransform transform;
	const double turn = 0.6;
	transform.to_world =
			glm::dmat2(2.0 * std::cos(turn), -2.0 * std::sin(turn), 3.0 * std::sin(turn), 3.0 * std::cos(turn));
	transform.origin = {100.0, -7.0, 40.0};
	transform.height_scale = 1.5;
	MapLayers layers;
	layers.heights = float_heights([](glm::ivec2 post) { return 0.5F * static_cast<float>(post.x) + 2.0F; });
	const MapField field = field_of(transform, layers);
	for (const MapField &map_field : {field, field.at_offset({1000.0, 50.0, -2000.0})}) {
		const glm::dvec3 origin = map_field.transform().origin;
		const glm::dvec2 at = transform.to_world * glm::dvec2(10.25, 20.5) + glm::dvec2(origin.x, origin.z);
		const Ground ground = map_field.at(at);
		CHECK(ground.height == doctest::Approx(origin.y + 1.5 * (0.5 * 10.25 + 2.0)));
		// The height rises by 0.75 m every 2 m along the columns of the map.
		const glm::dvec2 east{std::cos(turn), -std::sin(turn)};
		const glm::vec3 expected(glm::normalize(glm::dvec3(-0.375 * east.x, 1.0, -0.375 * east.y)));
		CHECK(glm::distance(ground.normal, expected) < 1e-6F);
	}
}

TEST_CASE("map field: samples of all formats are read correctly") {
	CHECK(half_to_float(0x0000) == 0.0F);
	CHECK(half_to_float(0x3c00) == 1.0F);
	CHECK(half_to_float(0xc500) == -5.0F);
	CHECK(half_to_float(0x7bff) == 65504.0F);
	CHECK(half_to_float(0x0001) == 0x1p-24F);
	CHECK(half_to_float(0x83ff) == -1023 * 0x1p-24F);
	CHECK(half_to_float(0x3555) == 0x1.554p-2F);
	CHECK(std::isinf(half_to_float(0x7c00)));
	CHECK(std::isnan(half_to_float(0x7e01)));
	MapLayers layers;
	layers.format = PostFormat::float16;
	layers.heights = grid_of(2, [](glm::ivec2 post, std::uint8_t *pixel) {
		const auto half = static_cast<std::uint16_t>(0x4000 + 64 * post.x); // 2 + column / 8
		std::memcpy(pixel, &half, 2);
	});
	CHECK(field_of({}, layers).at({6.0, 3.0}).height == 2.75F);
	layers.format = PostFormat::rgb8;
	layers.heights = grid_of(3, [](glm::ivec2 post, std::uint8_t *pixel) {
		const int steps = (8192 + 100 * post.x) * 1024 + 512;
		pixel[0] = static_cast<std::uint8_t>(steps);
		pixel[1] = static_cast<std::uint8_t>(steps >> 8);
		pixel[2] = static_cast<std::uint8_t>(steps >> 16);
	});
	CHECK(field_of({}, layers).at({6.5, 3.0}).height == 650.5F);
	layers.format = PostFormat::float32;
	layers.heights = float_heights(
			[](glm::ivec2 post) { return post == glm::ivec2(5, 5) ? std::numeric_limits<float>::infinity() : 1.0F; });
	CHECK(std::isnan(field_of({}, layers).at({4.5, 4.5}).height));
	CHECK(field_of({}, layers).at({3.5, 4.5}).height == 1.0F);
}

TEST_CASE("map field: a hole is where the color map's alpha is below a half") {
	MapLayers layers = plain_layers();
	layers.colors = bytes_grid([](glm::ivec2 post) { return std::array{0, 0, 0, post.x == 10 ? 0 : 255}; }, 4);
	const MapField field = field_of({}, layers);
	CHECK(std::isnan(field.at({10.0, 4.5}).height));
	CHECK(std::isnan(field.at({9.51, 4.5}).height));
	CHECK_FALSE(std::isnan(field.at({9.49, 4.5}).height));
	CHECK_FALSE(std::isnan(field.at({10.51, 4.5}).height));
}

TEST_CASE("map field: each splat map contains the weights of four textures") {
	MapLayers layers = plain_layers();
	// Without splat maps, every texture has full weight everywhere.
	CHECK(weight(field_of({}, layers), {3.0, 3.0}, {0}) == 1.0F);
	layers.splats.push_back(bytes_grid([](glm::ivec2 post) { return std::array{post.x < 10 ? 255 : 0, 0, 0, 0}; }, 4));
	layers.splats.push_back(bytes_grid([](glm::ivec2 post) { return std::array{0, 0, post.x < 10 ? 0 : 255, 0}; }, 4));
	const MapField field = field_of({}, layers);
	CHECK(weight(field, {5.0, 5.0}, {0}) == 1.0F);
	CHECK(weight(field, {15.0, 5.0}, {0, 1, 2, 3, 7, 8, -2}) == 0.0F);
	CHECK(weight(field, {15.0, 5.0}, {6}) == 1.0F);
	CHECK(weight(field, {9.25, 5.0}, {0}) == doctest::Approx(0.75));
	CHECK(weight(field, {9.25, 5.0}, {0, 6}) == doctest::Approx(1.0));
	CHECK(weight(field, {-5.0, 5.0}, {0}) == 0.0F);
}

TEST_CASE("map field: index and weight maps define three textures per pixel") {
	MapLayers layers = plain_layers();
	// The splat map is ignored.
	layers.splats.push_back(bytes_grid([](glm::ivec2) { return std::array{255, 0, 0, 0}; }, 4));
	layers.indices = bytes_grid([](glm::ivec2 post) { return std::array{post.x < 10 ? 20 : 5, 21, 200, 0}; }, 3);
	layers.weights = bytes_grid([](glm::ivec2) { return std::array{102, 51, 0, 0}; }, 2);
	const MapField field = field_of({}, layers);
	CHECK(weight(field, {5.0, 5.0}, {0}) == 0.0F);
	CHECK(weight(field, {5.0, 5.0}, {20}) == doctest::Approx(0.4));
	CHECK(weight(field, {5.0, 5.0}, {21}) == doctest::Approx(0.2));
	CHECK(weight(field, {5.0, 5.0}, {200}) == doctest::Approx(0.4));
	CHECK(weight(field, {5.0, 5.0}, {20, 21, 200}) == doctest::Approx(1.0));
	CHECK(weight(field, {9.5, 5.0}, {5}) == doctest::Approx(0.2)); // Halfway to a pixel without this texture.
	layers.indices = bytes_grid([](glm::ivec2) { return std::array{7, 7, 7, 0}; }, 3);
	CHECK(weight(field_of({}, layers), {5.0, 5.0}, {7}) == 1.0F);
}

TEST_CASE("map field: an invalid map is rejected, and the field stays unchanged") {
	MapField field = field_of({}, plain_layers());
	const MapLayers good = plain_layers();
	CHECK_FALSE(field.set({}, {}).ok());
	MapTransform flat;
	flat.to_world = glm::dmat2(1.0, 0.0, 2.0, 0.0);
	CHECK_FALSE(field.set(flat, good).ok());
	MapTransform invalid_transform;
	invalid_transform.origin.y = std::nan("");
	CHECK_FALSE(field.set(invalid_transform, good).ok());
	const PixelGrid small = grid_of(4, [](glm::ivec2, std::uint8_t *) {}, 8);
	for (const auto layer : {&MapLayers::colors, &MapLayers::indices, &MapLayers::weights}) {
		MapLayers bad = good;
		bad.*layer = small;
		CHECK(field.set({}, bad).code == ErrorCode::wrong_size);
	}
	MapLayers bad = good;
	bad.splats.push_back(small);
	CHECK(field.set({}, bad).code == ErrorCode::wrong_size);
	const auto bytes = std::make_shared<Bytes>(static_cast<std::size_t>(posts) * 8 * 4);
	MapLayers low = good;
	REQUIRE(low.colors.set({posts, 8}, 4, {bytes, *bytes}).ok());
	const Status of_rows = field.set({}, low);
	CHECK(of_rows.code == ErrorCode::wrong_size);
	CHECK(of_rows.value == 8.0);
	MapLayers half = good;
	half.indices = grid_of(3, [](glm::ivec2, std::uint8_t *) {});
	CHECK(field.set({}, half).code == ErrorCode::missing);
	CHECK(field.at({5.0, 5.0}).height == post_at({5, 5}));
	std::array<Ground, 2> two;
	const glm::dvec2 origin{0.0};
	CHECK(field.sample({&origin, 1}, two).code == ErrorCode::wrong_size);
	CHECK(field.weigh({&origin, 1}, {}, two).code == ErrorCode::wrong_size);
}
