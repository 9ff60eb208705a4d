#include "core/rules/image_mask.hpp"
#include "core/rules/planet_mask.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

using namespace thicket;

namespace {

using Pixels = std::vector<std::uint8_t>;

/// 5 columns and 3 rows on 40 m by 12 m, with the origin inside. Pixels are 8 m by 4 m.
constexpr glm::ivec2 size{5, 3};
const Rect area{{-24.0, -8.0}, {16.0, 4.0}};
const Pixels pixels{0, 10, 20, 30, 255, 50, 60, 70, 80, 90, 200, 110, 120, 130, 140};
constexpr std::array edges{MaskEdge::nothing, MaskEdge::everything, MaskEdge::clamp, MaskEdge::repeat};

ImageMask mask_of(glm::ivec2 of_size, const Pixels &of_pixels, const Rect &of_area, MaskEdge edge) {
	ImageMask mask;
	REQUIRE(mask.set(of_size, of_pixels, of_area, edge).ok());
	return mask;
}

float density(const ImageMask &mask, glm::dvec2 position) {
	float value = -1.0f;
	REQUIRE(mask.sample({&position, 1}, {&value, 1}).ok());
	return value;
}

float byte(int value) { return static_cast<float>(value / 255.0); }

/// Returns the expected density at a position: the weighted mean of its four pixels, with clamped
/// or wrapped indices.
double expected_at(glm::dvec2 position, bool repeat) {
	const double x = (position.x + 24.0) / 8.0 - 0.5;
	const double y = (position.y + 8.0) / 4.0 - 0.5;
	const auto clamped = [&](int index, int count) {
		return repeat ? ((index % count) + count) % count : std::clamp(index, 0, count - 1);
	};
	const auto pixel = [&](int column, int row) {
		return double{1} * pixels[static_cast<std::size_t>(clamped(row, size.y) * size.x + clamped(column, size.x))];
	};
	const int column = static_cast<int>(std::floor(x));
	const int row = static_cast<int>(std::floor(y));
	const double right = x - column;
	const double y_fraction = y - row;
	return ((pixel(column, row) * (1 - right) + pixel(column + 1, row) * right) * (1 - y_fraction) +
				   (pixel(column, row + 1) * (1 - right) + pixel(column + 1, row + 1) * right) * y_fraction) /
			255.0;
}

} // namespace

TEST_CASE("image mask: a pixel's center has exactly its value") {
	for (const MaskEdge edge : edges) {
		const ImageMask mask = mask_of(size, pixels, area, edge);
		for (int row = 0; row < size.y; ++row) {
			for (int column = 0; column < size.x; ++column) {
				const glm::dvec2 center(-24.0 + (column + 0.5) * 8.0, -8.0 + (row + 0.5) * 4.0);
				CHECK(density(mask, center) == byte(pixels[static_cast<std::size_t>(row * size.x + column)]));
			}
		}
	}
}

TEST_CASE("image mask: densities are bilinear between pixel centers, and clamped or wrapped at the border") {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int i = 0; i < 2000; ++i) {
		const glm::dvec2 inside(-24.0 + 40.0 * unit(random), -8.0 + 12.0 * unit(random));
		for (const MaskEdge edge : edges) {
			const double expected = expected_at(inside, edge == MaskEdge::repeat);
			CHECK(std::abs(density(mask_of(size, pixels, area, edge), inside) - expected) < 1e-6);
		}
		const glm::dvec2 anywhere(400.0 * unit(random) - 200.0, 100.0 * unit(random) - 50.0);
		CHECK(std::abs(density(mask_of(size, pixels, area, MaskEdge::repeat), anywhere) - expected_at(anywhere, true)) <
				1e-6);
		const glm::dvec2 clamped = glm::dvec2(
				std::clamp(anywhere.x, area.min.x, area.max.x), std::clamp(anywhere.y, area.min.y, area.max.y));
		CHECK(std::abs(density(mask_of(size, pixels, area, MaskEdge::clamp), anywhere) - expected_at(clamped, false)) <
				1e-6);
	}
}

TEST_CASE("image mask: positions outside use the edge mode, at all four borders") {
	struct Case {
		glm::dvec2 position;
		bool is_inside;
		int nearest; ///< Pixel value at the nearest position inside the image.
	};
	const double tolerance = 1e-9;
	// Positions on the center line of a column or row: on each border, inside it and outside it.
	// The last two are outside at a corner.
	const std::array cases{Case{{-24.0, -2.0}, true, 50}, Case{{-24.0 - tolerance, -2.0}, false, 50},
			Case{{-1000.0, -2.0}, false, 50}, Case{{16.0 - tolerance, -2.0}, true, 90}, Case{{16.0, -2.0}, false, 90},
			Case{{1000.0, -2.0}, false, 90}, Case{{-4.0, -8.0}, true, 20}, Case{{-4.0, -8.0 - tolerance}, false, 20},
			Case{{-4.0, -1e9}, false, 20}, Case{{-4.0, 4.0 - tolerance}, true, 120}, Case{{-4.0, 4.0}, false, 120},
			Case{{-4.0, 1e9}, false, 120}, Case{{99.0, -99.0}, false, 255}, Case{{-99.0, 99.0}, false, 200}};
	for (const Case &each : cases) {
		CAPTURE(each.position.x);
		CAPTURE(each.position.y);
		const auto at = [&](MaskEdge edge) {
			return density(mask_of(size, pixels, area, edge), each.position);
		};
		CHECK(at(MaskEdge::nothing) == (each.is_inside ? byte(each.nearest) : 0.0f));
		CHECK(at(MaskEdge::everything) == (each.is_inside ? byte(each.nearest) : 1.0f));
		CHECK(at(MaskEdge::clamp) == byte(each.nearest));
	}
}

TEST_CASE("image mask: a repeated image is periodic, without a seam") {
	const ImageMask mask = mask_of(size, pixels, area, MaskEdge::repeat);
	std::mt19937 random(2);
	for (int i = 0; i < 500; ++i) {
		// Multiples of 1/8 m are exact in all copies.
		const glm::dvec2 position(
				static_cast<int>(random() % 320) / 8.0 - 24.0, static_cast<int>(random() % 96) / 8.0 - 8.0);
		const double copies_x = static_cast<int>(random() % 2001) - 1000;
		const double copies_y = static_cast<int>(random() % 2001) - 1000;
		const glm::dvec2 copy = position + glm::dvec2(40.0 * copies_x, 12.0 * copies_y);
		CHECK(std::abs(density(mask, position) - density(mask, copy)) < 1e-6f);
	}
	for (const double border : {-24.0, 16.0, 56.0, -4024.0}) {
		CHECK(std::abs(density(mask, {border - 1e-9, -3.0}) - density(mask, {border + 1e-9, -3.0})) < 1e-6f);
		CHECK(density(mask, {border, -6.0}) == byte(0) + (byte(255) - byte(0)) / 2.0f);
	}
}

TEST_CASE("image mask: an image of one pixel has one value") {
	for (const int value : {0, 77, 255}) {
		const Pixels single_pixel{static_cast<std::uint8_t>(value)};
		for (const MaskEdge edge : edges) {
			const ImageMask mask = mask_of({1, 1}, single_pixel, {{-3.0, 5.0}, {-1.0, 9.0}}, edge);
			for (const glm::dvec2 position :
					{glm::dvec2(-3.0, 5.0), glm::dvec2(-2.0, 7.0), glm::dvec2(-1.0001, 8.9999)}) {
				CHECK(density(mask, position) == byte(value));
			}
		}
		CHECK(density(mask_of({1, 1}, single_pixel, area, MaskEdge::clamp), {1e6, 1e6}) == byte(value));
		CHECK(density(mask_of({1, 1}, single_pixel, area, MaskEdge::repeat), {1e6, -1e6}) == byte(value));
	}
	const ImageMask row = mask_of({2, 1}, {0, 255}, {{0.0, 0.0}, {2.0, 1.0}}, MaskEdge::clamp);
	CHECK(density(row, {1.0, 0.9}) == 0.5f);
	const ImageMask column = mask_of({1, 2}, {0, 255}, {{0.0, 0.0}, {1.0, 2.0}}, MaskEdge::clamp);
	CHECK(density(column, {0.9, 0.75}) == 0.25f);
}

TEST_CASE("image mask: positions that are not finite have no density") {
	for (const MaskEdge edge : edges) {
		const ImageMask mask = mask_of(size, pixels, area, edge);
		for (const double bad : {nan_value, infinite_value, -infinite_value}) {
			CHECK(density(mask, {bad, 0.0}) == 0.0f);
			CHECK(density(mask, {0.0, bad}) == 0.0f);
		}
		for (const double coordinate : {1e300, -1e300}) {
			CHECK(density(mask, {coordinate, coordinate}) >= 0.0f);
			CHECK(density(mask, {coordinate, coordinate}) <= 1.0f);
		}
	}
	// The image is so small that a position divided by its size overflows.
	const ImageMask tiny = mask_of({1, 1}, {255}, {{0.0, 0.0}, {1e-300, 1e-300}}, MaskEdge::repeat);
	CHECK(density(tiny, {1e10, 0.0}) == 0.0f);
	CHECK(density(tiny, {5e-301, 0.0}) == 1.0f);
	// An image nearly as wide as the range of double.
	const ImageMask vast = mask_of({2, 1}, {0, 255}, {{-8e307, -8e307}, {8e307, 8e307}}, MaskEdge::clamp);
	CHECK(density(vast, {0.0, 0.0}) == 0.5f);
	CHECK(density(vast, {1.7e308, 0.0}) == 1.0f);
}

TEST_CASE("image mask: the default is 1 everywhere") {
	const ImageMask mask;
	CHECK(density(mask, {0.5, 0.5}) == 1.0f);
	CHECK(density(mask, {-1e6, 1e6}) == 1.0f);
}

TEST_CASE("image mask: a position is bit-identical in any batch") {
	std::mt19937 random(3);
	std::uniform_real_distribution<double> along(-60.0, 60.0);
	for (const MaskEdge edge : edges) {
		const ImageMask mask = mask_of(size, pixels, area, edge);
		std::vector<glm::dvec2> positions(300);
		std::ranges::generate(positions, [&] { return glm::dvec2(along(random), along(random)); });
		std::vector<float> whole(positions.size());
		REQUIRE(mask.sample(positions, whole).ok());
		for (std::size_t i = 0; i < positions.size(); ++i) {
			CHECK(density(mask, positions[i]) == whole[i]);
		}
	}
}

TEST_CASE("image mask: errors name the invalid property and leave the mask unchanged") {
	ImageMask mask = mask_of(size, pixels, area, MaskEdge::clamp);
	const ImageMask before = mask;
	const auto refuse = [&](glm::ivec2 of_size, const Rect &of_area, ErrorCode code, const char *property,
								double value) {
		check_refused(mask.set(of_size, pixels, of_area, MaskEdge::repeat), code, property, value);
		CHECK(mask == before);
	};
	refuse({0, 15}, area, ErrorCode::out_of_range, "size", 0.0);
	refuse({15, 0}, area, ErrorCode::out_of_range, "size", 0.0);
	refuse({-5, -3}, area, ErrorCode::out_of_range, "size", -5.0);
	refuse({max_mask_pixels + 1, 1}, area, ErrorCode::out_of_range, "size", 16385.0);
	refuse({1, max_mask_pixels + 1}, area, ErrorCode::out_of_range, "size", 16385.0);
	refuse({5, 4}, area, ErrorCode::wrong_size, "pixels", 15.0);
	refuse({max_mask_pixels, max_mask_pixels}, area, ErrorCode::wrong_size, "pixels", 15.0);
	refuse(size, {{0.0, 0.0}, {0.0, 1.0}}, ErrorCode::not_positive, "area", 0.0);
	refuse(size, {{0.0, 0.0}, {1.0, -2.0}}, ErrorCode::not_positive, "area", -2.0);
	refuse(size, {{nan_value, 0.0}, {1.0, 1.0}}, ErrorCode::not_finite, "area", nan_value);
	refuse(size, {{0.0, 0.0}, {1.0, infinite_value}}, ErrorCode::not_finite, "area", infinite_value);
	refuse(size, {{-1e308, 0.0}, {1e308, 1.0}}, ErrorCode::not_finite, "area", infinite_value);
	check_refused(mask.set(size, pixels, area, static_cast<MaskEdge>(4)), ErrorCode::out_of_range, "edge", 4.0);
	CHECK(mask == before);
	std::vector<float> densities(2);
	check_refused(mask.sample(std::vector<glm::dvec2>(3), densities), ErrorCode::wrong_size, "density", 2.0);
}

TEST_CASE("image mask: masks differ by size, pixels, area and edge") {
	const ImageMask mask = mask_of(size, pixels, area, MaskEdge::clamp);
	Pixels other_pixels = pixels;
	other_pixels.front() ^= 1;
	CHECK(mask == mask_of(size, pixels, area, MaskEdge::clamp));
	CHECK_FALSE(mask == mask_of({3, 5}, pixels, area, MaskEdge::clamp));
	CHECK_FALSE(mask == mask_of(size, other_pixels, area, MaskEdge::clamp));
	CHECK_FALSE(mask == mask_of(size, pixels, {area.min, {17.0, 4.0}}, MaskEdge::clamp));
	CHECK_FALSE(mask == mask_of(size, pixels, {{-24.0, -9.0}, area.max}, MaskEdge::clamp));
	CHECK_FALSE(mask == mask_of(size, pixels, area, MaskEdge::repeat));
}

TEST_CASE("image mask: on a planet, the image covers the sphere like a texture on a SphereMesh") {
	std::mt19937 random(5);
	std::normal_distribution<double> normal;
	for (const MaskEdge edge : edges) {
		const ImageMask mask = mask_of(size, pixels, area, edge);
		for (int i = 0; i < 2000; ++i) {
			const glm::dvec3 from{normal(random), normal(random), normal(random)};
			const double turn = std::atan2(from.x, from.z) / (2.0 * std::numbers::pi);
			const double x = (turn < 0.0 ? turn + 1.0 : turn) * size.x - 0.5;
			const double y = std::acos(from.y / glm::length(from)) / std::numbers::pi * size.y - 0.5;
			const auto pixel = [&](int column, int row) {
				return double{1} *
						pixels[static_cast<std::size_t>(
								std::clamp(row, 0, size.y - 1) * size.x + (column + size.x) % size.x)];
			};
			const int column = static_cast<int>(std::floor(x));
			const int row = static_cast<int>(std::floor(y));
			const double upper = std::lerp(pixel(column, row), pixel(column + 1, row), x - column);
			const double lower = std::lerp(pixel(column, row + 1), pixel(column + 1, row + 1), x - column);
			CHECK(mask.toward(from) == doctest::Approx(std::lerp(upper, lower, y - row) / 255.0).epsilon(1e-6));
			CHECK(mask.toward(7.0 * from) == doctest::Approx(mask.toward(from)).epsilon(1e-9));
		}
	}
}

TEST_CASE("image mask: on a planet, there are no seams, and poles have a density") {
	const ImageMask mask = mask_of(size, pixels, area, MaskEdge::nothing);
	for (const double y : {-3.0, -0.5, 0.0, 0.7, 20.0}) {
		for (const double z : {1.0, -1.0}) {
			CHECK(mask.toward({1e-9, y, z}) == doctest::Approx(mask.toward({-1e-9, y, z})).epsilon(1e-6));
			CHECK(mask.toward({0.0, y, z}) == doctest::Approx(mask.toward({1e-9, y, z})).epsilon(1e-6));
		}
		CHECK(mask.toward({1.0, y, 1e-9}) == doctest::Approx(mask.toward({1.0, y, -1e-9})).epsilon(1e-6));
	}
	// At the poles, the left and right borders of the first and of the last row meet.
	CHECK(mask.toward({0.0, 2.0, 0.0}) == doctest::Approx(0.5 * (0.0 + 255.0) / 255.0));
	CHECK(mask.toward({0.0, -2.0, 0.0}) == doctest::Approx(0.5 * (200.0 + 140.0) / 255.0));
	CHECK(mask.toward({0.0, 0.0, 0.0}) == mask.toward({0.0, 2.0, 0.0}));
	CHECK(mask.toward({0.0, std::nan(""), 1.0}) == 0.0);
	CHECK(mask.toward({std::numeric_limits<double>::infinity(), 0.0, 1.0}) == 0.0);
	const Planet planet{{3.0, -5.0, 8.0}, 20.0};
	const PlanetMask on_planet(std::make_shared<const ImageMask>(mask), planet);
	const glm::dvec2 position{9.0, 4.0};
	const float height = 11.0f;
	float value = -1.0f;
	REQUIRE(on_planet.sample_in_space({&position, 1}, {&height, 1}, {&value, 1}).ok());
	CHECK(value == static_cast<float>(mask.toward({6.0, 16.0, -4.0})));
	REQUIRE(on_planet.sample({&position, 1}, {&value, 1}).ok());
	CHECK(value == static_cast<float>(mask.toward({6.0, std::sqrt(20.0 * 20.0 - 52.0), -4.0})));
	CHECK_FALSE(on_planet.sample({&position, 1}, {}).ok());
	CHECK_FALSE(on_planet.sample_in_space({&position, 1}, {}, {&value, 1}).ok());
}
