#include "core/rules/painted_mask.hpp"
#include "mask_fixture.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <thread>
#include <span>
#include <vector>

using namespace thicket;

namespace {

using Pixels = std::vector<std::uint8_t>;

Pixels random_pixels(std::size_t count, unsigned seed) {
	std::mt19937 random(seed);
	Pixels pixels(count);
	std::ranges::generate(pixels, [&] { return static_cast<std::uint8_t>(random()); });
	return pixels;
}

} // namespace

TEST_CASE("painted mask: an unpainted mask is background everywhere") {
	for (const double background : {0.0, 0.25, 1.0}) {
		const PaintedMask mask = mask_of(0.5, background);
		CHECK(std::abs(mask.background() - background) <= 0.5 / 255.0);
		for (const glm::dvec2 position :
				{glm::dvec2(0.0), glm::dvec2(-1e9, 1e9), glm::dvec2(31.9, -32.1), glm::dvec2(1e300)}) {
			CHECK(density(mask, position) == static_cast<float>(mask.background()));
		}
		CHECK(mask.block_count() == 0);
	}
	CHECK(density(PaintedMask(), {3.0, 4.0}) == 1.0f);
	CHECK(PaintedMask().pixel_size() == 1.0);
}

TEST_CASE("painted mask: a pixel covers its square and has its value at the center, on both sides of the origin") {
	constexpr double size = 0.75;
	PaintedMask mask = mask_of(size, 0.0);
	const PixelRect region{{-66, -3}, {3, 67}}; // The region covers parts of nine blocks.
	const Pixels pixels = random_pixels(69 * 70, 1);
	write(mask, region, pixels);
	for (int y = region.min.y; y < region.max.y; ++y) {
		for (int x = region.min.x; x < region.max.x; ++x) {
			const int value = pixels[static_cast<std::size_t>((y + 3) * 69 + x + 66)];
			REQUIRE(density(mask, {(x + 0.5) * size, (y + 0.5) * size}) == byte_density(value));
			REQUIRE(pixel(mask, x, y) == value);
		}
	}
	CHECK(pixel(mask, -67, 0) == 0);
	CHECK(pixel(mask, 3, 0) == 0);
	CHECK(pixel(mask, 0, -4) == 0);
	CHECK(pixel(mask, 0, 67) == 0);
	CHECK(mask.block_count() == 9);
}

TEST_CASE("painted mask: densities are bilinear between pixel centers, even across the borders of blocks") {
	for (const double size : {1.0, 0.3}) {
		const PaintedMask mask = noisy_mask(size, 2);
		std::mt19937 random(3);
		std::uniform_real_distribution<double> along(-72.0, 72.0);
		const auto check = [&](double x, double y) {
			const double column = std::floor(x);
			const double top = std::floor(y);
			const Pixels four = read(mask,
					{{static_cast<int>(column), static_cast<int>(top)},
							{static_cast<int>(column) + 2, static_cast<int>(top) + 2}});
			const double right = x - column;
			const double y_fraction = y - top;
			const double expected = (1 - right) * (1 - y_fraction) * four[0] + right * (1 - y_fraction) * four[1] +
					(1 - right) * y_fraction * four[2] + right * y_fraction * four[3];
			REQUIRE(std::abs(density(mask, {(x + 0.5) * size, (y + 0.5) * size}) - expected / 255.0) < 1e-6);
		};
		for (int i = 0; i < 2000; ++i) {
			check(along(random), along(random));
			// Positions between the last pixel of a block and the first pixel of the next.
			check(-1.0 + 0.01 * (i % 100), along(random));
			check(along(random), 63.0 + 0.01 * (i % 100));
			check(-65.0 + 0.01 * (i % 100), -65.0 + 0.01 * (i / 20));
		}
	}
}

TEST_CASE("painted mask: positions that are not finite have no density") {
	const PaintedMask mask = noisy_mask(1.0, 4);
	for (const double bad : {nan_value, infinite_value, -infinite_value}) {
		CHECK(density(mask, {bad, 0.0}) == 0.0f);
		CHECK(density(mask, {0.0, bad}) == 0.0f);
	}
}

TEST_CASE("painted mask: a position is bit-identical in any batch") {
	const PaintedMask mask = noisy_mask(0.7, 5);
	std::mt19937 random(6);
	std::uniform_real_distribution<double> along(-60.0, 60.0);
	std::vector<glm::dvec2> positions(2000);
	std::ranges::generate(positions, [&] { return glm::dvec2(along(random), along(random)); });
	std::vector<float> whole(positions.size());
	REQUIRE(mask.sample(positions, whole).ok());
	for (std::size_t i = 0; i < positions.size(); ++i) {
		CHECK(density(mask, positions[i]) == whole[i]);
	}
}

TEST_CASE("painted mask: a copy keeps its state while painting continues and another thread reads it") {
	PaintedMask mask = noisy_mask(1.0, 7);
	const PaintedMask copy = mask;
	const PixelRect all{{-80, -80}, {80, 80}};
	const Pixels before = read(copy, all);
	std::atomic<bool> is_finished = false;
	std::atomic<int> wrong_count = 0;
	std::thread worker([&] {
		Pixels pixels;
		do {
			wrong_count += !copy.read(all, pixels).ok() || pixels != before;
		} while (!is_finished);
	});
	for (int i = 0; i < 100; ++i) {
		paint(mask, {.mode = static_cast<Brush::Mode>(i % 3), .center = {i - 50.0, 50.0 - i}, .radius = 30.0});
	}
	is_finished = true;
	worker.join();
	CHECK(wrong_count == 0);
	CHECK(read(copy, all) == before);
	CHECK_FALSE(read(mask, all) == before);
	CHECK(mask.reset(1.0, 0.5).ok());
	CHECK(read(copy, all) == before);
}

TEST_CASE("painted mask: pixels that are read and written back restore the mask") {
	PaintedMask mask = noisy_mask(0.5, 8);
	const PaintedMask before = mask;
	std::mt19937 random(9);
	std::uniform_real_distribution<double> along(-60.0, 60.0);
	for (int i = 0; i < 50; ++i) {
		const Brush brush{.mode = static_cast<Brush::Mode>(i % 3),
				.center = {along(random), along(random)},
				.radius = 0.3 + std::abs(along(random)) / 3.0};
		const PixelRect region = mask.pixels_of({brush.center - brush.radius, brush.center + brush.radius});
		const Pixels old = read(mask, region);
		const PaintedMask undone = mask;
		const Rect changed_rect = paint(mask, brush);
		const Pixels painted_pixels = read(mask, region);
		const PaintedMask painted = mask;
		const Rect restored_rect = write(mask, region, old);
		CHECK(mask == undone);
		CHECK((restored_rect.min == changed_rect.min && restored_rect.max == changed_rect.max));
		write(mask, region, painted_pixels); // Redo the change.
		CHECK(mask == painted);
	}
	CHECK_FALSE(mask == before);
}

TEST_CASE("painted mask: writing returns the changed rectangle, and repeating it has no effect") {
	PaintedMask mask = mask_of(2.0, 0.0);
	const PixelRect region{{-3, 5}, {4, 9}};
	Pixels pixels(7 * 4, 0);
	CHECK(write(mask, region, pixels).empty());
	CHECK(mask.block_count() == 0);
	pixels[2 * 7 + 5] = 9; // Pixel (2, 7) affects positions from the center of (1, 6) to the center of (3, 8).
	pixels[1 * 7 + 4] = 9; // This index is the pixel (1, 6).
	const Rect changed_rect = write(mask, region, pixels);
	CHECK(changed_rect.min == glm::dvec2(1.0, 11.0));
	CHECK(changed_rect.max == glm::dvec2(7.0, 17.0));
	CHECK(write(mask, region, pixels).empty());
	CHECK(write(mask, {{3, 3}, {3, 3}}, {}).empty());
	CHECK(read(mask, {{7, 7}, {7, 99}}).empty());
}

TEST_CASE("painted mask: a pixel contributes to no density outside the changed rectangle") {
	std::mt19937 random(14);
	std::uniform_real_distribution<double> unit(0.05, 9.0);
	for (int round = 0; round < 1000; ++round) {
		const double size = unit(random);
		PaintedMask mask = mask_of(size, 0.0);
		const glm::ivec2 at(static_cast<int>(random() % 2000) - 1000, static_cast<int>(random() % 2000) - 1000);
		const Rect changed_rect = write(mask, {at, at + 1}, {255});
		const glm::dvec2 middle = (glm::dvec2(at) + 0.5) * size;
		REQUIRE(density(mask, {changed_rect.max.x, middle.y}) == 0.0f);
		REQUIRE(density(mask, {middle.x, changed_rect.max.y}) == 0.0f);
		REQUIRE(density(mask, {std::nextafter(changed_rect.min.x, -1e9), middle.y}) == 0.0f);
		REQUIRE(density(mask, {middle.x, std::nextafter(changed_rect.min.y, -1e9)}) == 0.0f);
		// The rectangle is no larger than the area that the pixel affects.
		REQUIRE(density(mask, {changed_rect.max.x - 1e-6 * size, middle.y}) > 0.0f);
		REQUIRE(density(mask, {changed_rect.min.x + 1e-6 * size, middle.y}) > 0.0f);
	}
}

TEST_CASE("painted mask: a block that is painted back to the background equals a missing one") {
	PaintedMask mask = mask_of(1.0, 1.0);
	const PaintedMask before = mask;
	paint(mask, {.mode = Brush::Mode::erase, .center = {10.0, -10.0}, .radius = 100.0, .hardness = 1.0});
	CHECK(mask.block_count() >= 9);
	CHECK_FALSE(mask == before);
	paint(mask, {.center = {10.0, -10.0}, .radius = 101.0, .hardness = 1.0});
	CHECK(mask == before);
	CHECK(mask.block_count() == 0);
	CHECK(mask.to_bytes() == before.to_bytes());
}

TEST_CASE("painted mask: masks differ by pixel size, background and any one pixel") {
	const PaintedMask mask = noisy_mask(1.0, 10);
	CHECK(mask == noisy_mask(1.0, 10));
	CHECK_FALSE(mask == noisy_mask(2.0, 10));
	CHECK_FALSE(mask_of(1.0, 0.0) == mask_of(1.0, 0.1));
	for (const glm::ivec2 at : {glm::ivec2(0, 0), glm::ivec2(-70, 69), glm::ivec2(1000, 1000)}) {
		PaintedMask other = mask;
		const PixelRect single_pixel{at, at + 1};
		const int value = pixel(mask, at.x, at.y);
		write(other, single_pixel, {static_cast<std::uint8_t>(value ^ 1)});
		CHECK_FALSE(other == mask);
		write(other, single_pixel, {static_cast<std::uint8_t>(value)});
		CHECK(other == mask);
	}
}

TEST_CASE("painted mask: the pixels of an area are those that determine its densities") {
	const PaintedMask mask = noisy_mask(0.6, 11);
	std::mt19937 random(12);
	std::uniform_real_distribution<double> along(-40.0, 40.0);
	for (int i = 0; i < 200; ++i) {
		const glm::dvec2 corner(along(random), along(random));
		const Rect area{corner, corner + glm::dvec2(0.01 + std::abs(along(random)) / 20.0, 0.5)};
		const PixelRect region = mask.pixels_of(area);
		// A mask with only these pixels has the same densities in the area.
		PaintedMask alone = mask_of(0.6, 0.0);
		write(alone, region, read(mask, region));
		for (const glm::dvec2 position : {area.min, area.max, area.center(), glm::dvec2(area.min.x, area.max.y)}) {
			CHECK(density(alone, position) == density(mask, position));
		}
		const glm::dvec2 pixels = area.size() / 0.6;
		CHECK(region.max.x - region.min.x <= pixels.x + 3.0);
		CHECK(region.max.y - region.min.y <= pixels.y + 3.0);
	}
	CHECK(mask.pixels_of({}).empty());
	CHECK(mask.pixels_of({{1.0, 1.0}, {0.0, 2.0}}).empty());
	CHECK(mask.pixels_of({{nan_value, 1.0}, {5.0, 2.0}}).empty());
	const PixelRect all_pixels = mask.pixels_of({glm::dvec2(-infinite_value), glm::dvec2(infinite_value)});
	CHECK(all_pixels.min == glm::ivec2(-PaintedMask::pixel_limit));
	CHECK(all_pixels.max == glm::ivec2(PaintedMask::pixel_limit));
}

TEST_CASE("painted mask: the last pixels of the plane are like all others, with background beyond them") {
	constexpr int limit = PaintedMask::pixel_limit;
	PaintedMask mask = mask_of(1.0, 0.0);
	const PixelRect last{{limit - 2, limit - 2}, {limit, limit}};
	const PixelRect first{{-limit, -limit}, {-limit + 2, -limit + 2}};
	const Pixels pixels{51, 102, 153, 204};
	write(mask, last, pixels);
	write(mask, first, pixels);
	CHECK(read(mask, last) == pixels);
	CHECK(read(mask, first) == pixels);
	CHECK(density(mask, glm::dvec2(limit - 1.5)) == 0.2f);
	CHECK(density(mask, glm::dvec2(0.5 - limit)) == 0.2f);
	CHECK(density(mask, glm::dvec2(1.5 - limit)) == 0.8f);
	CHECK(density(mask, glm::dvec2(limit + 7.0)) == 0.0f);
	CHECK(density(mask, glm::dvec2(-limit - 7.0)) == 0.0f);
}

TEST_CASE("painted mask: errors name the invalid property and leave the mask unchanged") {
	constexpr int limit = PaintedMask::pixel_limit;
	PaintedMask mask = noisy_mask(1.0, 13);
	const PaintedMask before = mask;
	check_refused(mask.reset(nan_value, 0.5), ErrorCode::not_finite, "pixel_size", nan_value);
	check_refused(mask.reset(1.0 / 65.0, 0.5), ErrorCode::out_of_range, "pixel_size", 1.0 / 65.0);
	check_refused(mask.reset(1025.0, 0.5), ErrorCode::out_of_range, "pixel_size", 1025.0);
	check_refused(mask.reset(1.0, -0.1), ErrorCode::out_of_range, "background", -0.1);
	check_refused(mask.reset(1.0, 1.1), ErrorCode::out_of_range, "background", 1.1);
	check_refused(mask.reset(1.0, infinite_value), ErrorCode::not_finite, "background", infinite_value);
	CHECK(mask == before);

	Rect changed_rect{{1.0, 2.0}, {3.0, 4.0}};
	Pixels pixels{7};
	const auto refuse = [&](const PixelRect &region, ErrorCode code, double value) {
		check_refused(mask.read(region, pixels), code, "region", value);
		check_refused(mask.write(region, Pixels(4), changed_rect), code, "region", value);
		CHECK(pixels == Pixels{7});
		CHECK(changed_rect.min == glm::dvec2(1.0, 2.0));
		CHECK(mask == before);
	};
	refuse({{0, 0}, {-1, 5}}, ErrorCode::inverted, -1.0);
	refuse({{0, 5}, {5, 4}}, ErrorCode::inverted, 4.0);
	refuse({{-limit - 1, 0}, {0, 1}}, ErrorCode::out_of_range, -limit - 1.0);
	refuse({{0, 0}, {1, limit + 1}}, ErrorCode::out_of_range, limit + 1.0);
	refuse({{0, 0}, {4097, 4096}}, ErrorCode::out_of_range, 4097.0 * 4096.0);
	refuse({{-limit, -limit}, {limit, limit}}, ErrorCode::out_of_range, 0x1p62);
	check_refused(mask.write({{0, 0}, {2, 1}}, Pixels(3), changed_rect), ErrorCode::wrong_size, "pixels", 3.0);
	check_refused(mask.write({{-limit, 0}, {limit, 0}}, Pixels(3), changed_rect), ErrorCode::wrong_size, "pixels", 3.0);
	std::vector<float> densities(2);
	check_refused(mask.sample(std::vector<glm::dvec2>(3), densities), ErrorCode::wrong_size, "density", 2.0);
	CHECK(mask == before);
}

TEST_CASE("painted mask: a copy shares all blocks until they are painted, even with equal pixels") {
	PaintedMask mask;
	REQUIRE(mask.reset(1.0, 0.0).ok());
	std::vector<std::uint8_t> pixels(std::size_t{256} * 256, 7);
	Rect changed_rect;
	REQUIRE(mask.write({{0, 0}, {256, 256}}, pixels, changed_rect).ok());
	REQUIRE(mask.block_count() == 16);
	PaintedMask copy = mask;
	CHECK(copy.count_unshared_blocks(mask) == 0);
	REQUIRE(copy.write({{10, 10}, {200, 200}}, std::span(pixels).first(190 * 190), changed_rect).ok());
	CHECK(copy.count_unshared_blocks(mask) == 0); // The copy shares the original block again.
	pixels.assign(1, 9);
	REQUIRE(copy.write({{70, 70}, {71, 71}}, pixels, changed_rect).ok());
	REQUIRE(copy.write({{-5, 0}, {-4, 1}}, pixels, changed_rect).ok());
	CHECK(copy.count_unshared_blocks(mask) == 2);
	CHECK(mask.count_unshared_blocks(copy) == 2);
	CHECK(copy.differs(mask, changed_rect));
	pixels.assign(1, 7);
	REQUIRE(copy.write({{70, 70}, {71, 71}}, pixels, changed_rect).ok());
	CHECK(copy.count_unshared_blocks(mask) == 2); // The pixels are equal, but in separate memory.
}
