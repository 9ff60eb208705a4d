#include "core/rules/painted_mask.hpp"
#include "mask_fixture.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

using namespace thicket;

namespace {

using Mode = Brush::Mode;

/// Returns a random dab near the origin, in any mode. About a quarter of these dabs are only a few
/// pixels wide.
Brush random_brush(std::mt19937 &r_random, double pixel_size) {
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	const auto coordinate = [&] {
		return (160.0 * unit(r_random) - 80.0) * pixel_size;
	};
	Brush brush;
	brush.mode = static_cast<Mode>(r_random() % 3);
	brush.center = {coordinate(), coordinate()};
	brush.radius = (r_random() % 4 == 0 ? 3.0 : 40.0) * pixel_size * (unit(r_random) + 1e-3);
	brush.strength = r_random() % 4 == 0 ? 1.0 : unit(r_random);
	brush.hardness = r_random() % 4 == 0 ? 1.0 : unit(r_random);
	return brush;
}

/// Returns values just before, at and just after the end of a rectangle.
std::vector<double> about(double end) {
	constexpr double infinite_distance = std::numeric_limits<double>::infinity();
	return {std::nextafter(std::nextafter(end, -infinite_distance), -infinite_distance),
			std::nextafter(end, -infinite_distance), end, std::nextafter(end, infinite_distance)};
}

double deviation(const std::vector<std::uint8_t> &pixels) {
	const double count = static_cast<double>(pixels.size());
	const double mean = std::accumulate(pixels.begin(), pixels.end(), 0.0) / count;
	double sum = 0.0;
	for (const std::uint8_t value : pixels) {
		sum += (value - mean) * (value - mean);
	}
	return std::sqrt(sum / count);
}

} // namespace

TEST_CASE("brush: no density outside the rectangle that a dab returns has changed, up to its exact border") {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (const double size : {1.0, 0.3, 1.0 / 64.0, 7.7}) {
		PaintedMask mask = noisy_mask(size, 2);
		for (int round = 0; round < 60; ++round) {
			const PaintedMask before = mask;
			const Brush brush = random_brush(random, size);
			const Rect changed_rect = paint(mask, brush);
			REQUIRE((changed_rect.empty() == (mask == before)));
			const auto check = [&](glm::dvec2 position) {
				if (!changed_rect.contains(position)) {
					REQUIRE(density(mask, position) == density(before, position));
				}
			};
			for (int i = 0; i < 100; ++i) {
				const glm::dvec2 offset(4.0 * unit(random) - 2.0, 4.0 * unit(random) - 2.0);
				check(brush.center + (brush.radius + size) * offset);
				const glm::dvec2 inside =
						changed_rect.min + changed_rect.size() * glm::dvec2(unit(random), unit(random));
				for (const double x : {changed_rect.min.x, changed_rect.max.x}) {
					std::ranges::for_each(about(x), [&](double on_border) { check({on_border, inside.y}); });
				}
				for (const double y : {changed_rect.min.y, changed_rect.max.y}) {
					std::ranges::for_each(about(y), [&](double on_border) { check({inside.x, on_border}); });
				}
			}
		}
	}
}

TEST_CASE("brush: the rectangle that a dab returns is as small as possible") {
	std::mt19937 random(3);
	for (const double size : {1.0, 0.3}) {
		PaintedMask mask = noisy_mask(size, 4);
		for (int round = 0; round < 60; ++round) {
			const PaintedMask before = mask;
			const Rect changed_rect = paint(mask, random_brush(random, size));
			if (changed_rect.empty()) {
				continue;
			}
			// On each edge of the rectangle, at least one pixel of the outermost line has changed.
			const PixelRect region = {glm::ivec2(glm::round(changed_rect.min / size + 0.5)),
					glm::ivec2(glm::round(changed_rect.max / size - 0.5))};
			const auto differs = [&](const PixelRect &line) {
				return read(mask, line) != read(before, line);
			};
			CHECK(differs({region.min, {region.min.x + 1, region.max.y}}));
			CHECK(differs({region.min, {region.max.x, region.min.y + 1}}));
			CHECK(differs({{region.max.x - 1, region.min.y}, region.max}));
			CHECK(differs({{region.min.x, region.max.y - 1}, region.max}));
		}
	}
}

TEST_CASE("brush: a hard dab fills exactly the pixels whose centers lie in its circle") {
	for (const glm::dvec2 center : {glm::dvec2(0.0), glm::dvec2(-63.7, 64.2), glm::dvec2(1234.5, -4321.0)}) {
		for (const double radius : {0.4, 1.0, 5.3, 40.0}) {
			PaintedMask mask = mask_of(0.5, 0.0);
			paint(mask, {.center = center, .radius = radius, .hardness = 1.0});
			const PixelRect region = mask.pixels_of({center - radius - 2.0, center + radius + 2.0});
			const std::vector<std::uint8_t> pixels = read(mask, region);
			std::size_t index = 0;
			for (int y = region.min.y; y < region.max.y; ++y) {
				for (int x = region.min.x; x < region.max.x; ++x) {
					const double distance = std::hypot((x + 0.5) * 0.5 - center.x, (y + 0.5) * 0.5 - center.y);
					if (std::abs(distance - radius) > 1e-9) {
						REQUIRE(pixels[index] == (distance < radius ? 255 : 0));
					}
					++index;
				}
			}
		}
	}
}

TEST_CASE("brush: strength is full within the hard part, and falls smoothly to 0 at the rim") {
	for (const double strength : {1.0, 0.6}) {
		for (const double hardness : {0.0, 0.25, 0.75}) {
			PaintedMask mask = mask_of(1.0 / 16.0, 0.0);
			paint(mask, {.center = glm::dvec2(1.0 / 32.0), .radius = 4.0, .strength = strength, .hardness = hardness});
			int before = 255;
			for (int x = 0; x <= 70; ++x) {
				const double distance = x / 16.0;
				const double fraction = std::clamp((4.0 - distance) / (4.0 - 4.0 * hardness), 0.0, 1.0);
				const double expected = 255.0 * strength * fraction * fraction * (3.0 - 2.0 * fraction);
				const int value = pixel(mask, x, 0);
				CHECK(std::abs(value - expected) <= 1.0);
				CHECK(value <= before);
				CHECK(pixel(mask, -x, 0) == value);
				CHECK(pixel(mask, 0, x) == value);
				CHECK(pixel(mask, 0, -x) == value);
				before = value;
			}
			CHECK(before == 0);
			CHECK(pixel(mask, 0, 0) == std::lround(255.0 * strength));
		}
	}
}

TEST_CASE("brush: a dab moves any value by the same fraction of the way, up and down") {
	for (const int start : {0, 60, 128, 255}) {
		PaintedMask mask = mask_of(1.0, start / 255.0);
		PaintedMask erased = mask;
		paint(mask, {.center = {0.5, 0.5}, .strength = 0.25});
		CHECK(std::abs(pixel(mask, 0, 0) - (start + 0.25 * (255 - start))) <= 0.5);
		paint(erased, {.mode = Mode::erase, .center = {0.5, 0.5}, .strength = 0.25});
		CHECK(std::abs(pixel(erased, 0, 0) - 0.75 * start) <= 0.5);
	}
	PaintedMask mask = noisy_mask(1.0, 5);
	const PaintedMask before = mask;
	CHECK(paint(mask, {.center = {0.0, 0.0}, .radius = 50.0, .strength = 0.0}).empty());
	CHECK(mask == before);
}

TEST_CASE("brush: weak dabs reach their target eventually, except where they weigh less than half a step") {
	PaintedMask mask = mask_of(1.0, 0.0);
	const Brush weak{.center = {0.5, 0.5}, .radius = 40.0, .strength = 0.01, .hardness = 0.5};
	for (int dab = 0; dab < 300; ++dab) {
		paint(mask, weak);
	}
	CHECK(pixel(mask, 0, 0) == 255);
	CHECK(pixel(mask, 20, 0) == 255);
	CHECK(pixel(mask, 39, 0) == 0);
	CHECK(paint(mask, {.center = {0.5, 200.5}, .radius = 40.0, .strength = 0.0019}).empty());
	CHECK_FALSE(paint(mask, {.center = {0.5, 200.5}, .radius = 40.0, .strength = 0.002}).empty());
	for (int dab = 0; dab < 300; ++dab) {
		Brush erase = weak;
		erase.mode = Mode::erase;
		paint(mask, erase);
	}
	CHECK(pixel(mask, 0, 0) == 0);
}

TEST_CASE("brush: smoothing moves pixels to the mean of the window around them") {
	const PaintedMask before = noisy_mask(1.0, 6);
	PaintedMask mask = before;
	// The window is 2 * (20 / 4) + 1 pixels wide, and its mean is the mean of the unchanged pixels.
	paint(mask, {.mode = Mode::smooth, .center = {-60.0, 3.0}, .radius = 20.0, .hardness = 1.0});
	for (int y = -20; y < 26; y += 3) {
		for (int x = -81; x < -39; x += 3) {
			const std::vector<std::uint8_t> window = read(before, {{x - 5, y - 5}, {x + 6, y + 6}});
			const double mean = std::accumulate(window.begin(), window.end(), 0.0) / 121.0;
			if (std::hypot(x + 0.5 + 60.0, y + 0.5 - 3.0) < 20.0) {
				REQUIRE(std::abs(pixel(mask, x, y) - mean) <= 0.5);
			} else {
				REQUIRE(pixel(mask, x, y) == pixel(before, x, y));
			}
		}
	}
}

TEST_CASE("brush: smoothing removes noise, keeps flat areas and never leaves the existing range") {
	PaintedMask mask = noisy_mask(1.0, 7);
	const PixelRect middle{{-20, -20}, {20, 20}};
	double before = deviation(read(mask, middle));
	for (int dab = 0; dab < 4; ++dab) {
		paint(mask, {.mode = Mode::smooth, .center = {0.0, 0.0}, .radius = 40.0, .strength = 0.5});
		const double new_deviation = deviation(read(mask, middle));
		CHECK(new_deviation < 0.8 * before);
		before = new_deviation;
	}
	for (const int value : {0, 100, 255}) {
		PaintedMask flat = mask_of(1.0, value / 255.0);
		CHECK(paint(flat, {.mode = Mode::smooth, .radius = 33.0}).empty());
		CHECK(flat.block_count() == 0);
	}
	PaintedMask step = mask_of(1.0, 0.0);
	write(step, {{0, -64}, {64, 64}}, std::vector<std::uint8_t>(64 * 128, 200));
	paint(step, {.mode = Mode::smooth, .center = {0.0, 0.0}, .radius = 32.0, .hardness = 0.8});
	for (int x = -31; x < 31; ++x) {
		CHECK(pixel(step, x, 0) <= pixel(step, x + 1, 0));
	}
	CHECK(pixel(step, -30, 0) == 0);
	CHECK(std::abs(pixel(step, 0, 0) - 100) < 15);
	CHECK(pixel(step, 31, 0) == 200);
}

TEST_CASE("brush: a dab is the same at any position relative to the blocks") {
	for (const Mode mode : {Mode::paint, Mode::erase, Mode::smooth}) {
		PaintedMask first = noisy_mask(0.5, 8);
		const std::vector<std::uint8_t> all = read(first, {{-70, -70}, {70, 70}});
		paint(first, {.mode = mode, .center = {3.3125, -7.125}, .radius = 12.0, .strength = 0.7});
		for (const glm::ivec2 shift : {glm::ivec2(64, -64), glm::ivec2(31, 17), glm::ivec2(-100000, 99999)}) {
			PaintedMask second = mask_of(0.5, 0.5);
			write(second, {shift - 70, shift + 70}, all);
			const glm::dvec2 center = glm::dvec2(3.3125, -7.125) + 0.5 * glm::dvec2(shift);
			paint(second, {.mode = mode, .center = center, .radius = 12.0, .strength = 0.7});
			CHECK(read(second, {shift - 70, shift + 70}) == read(first, {{-70, -70}, {70, 70}}));
		}
	}
}

TEST_CASE("brush: errors name the invalid property and leave the mask unchanged") {
	PaintedMask mask = noisy_mask(0.5, 9);
	const PaintedMask before = mask;
	const auto refuse = [&](auto change, ErrorCode code, const char *property, double value) {
		Brush brush;
		change(brush);
		Rect changed_rect{{1.0, 2.0}, {3.0, 4.0}};
		check_refused(mask.paint(brush, changed_rect), code, property, value);
		CHECK(changed_rect.max == glm::dvec2(3.0, 4.0));
		CHECK(mask == before);
	};
	refuse([](auto &bad) { bad.mode = static_cast<Mode>(3); }, ErrorCode::out_of_range, "mode", 3.0);
	refuse([](auto &bad) { bad.center.x = nan_value; }, ErrorCode::not_finite, "center", nan_value);
	refuse([](auto &bad) { bad.center.y = -infinite_value; }, ErrorCode::not_finite, "center", -infinite_value);
	refuse([](auto &bad) { bad.center.x = 1e300; }, ErrorCode::out_of_range, "center", 1e300);
	refuse([](auto &bad) { bad.center.y = -0x1p29; }, ErrorCode::out_of_range, "center", -0x1p29);
	refuse([](auto &bad) { bad.center.y = 0x1p29 - 4.0; }, ErrorCode::out_of_range, "center", 0x1p29 - 4.0);
	refuse([](auto &bad) { bad.radius = 0.0; }, ErrorCode::not_positive, "radius", 0.0);
	refuse([](auto &bad) { bad.radius = -1.0; }, ErrorCode::not_positive, "radius", -1.0);
	refuse([](auto &bad) { bad.radius = nan_value; }, ErrorCode::not_finite, "radius", nan_value);
	refuse([](auto &bad) { bad.radius = 512.5; }, ErrorCode::out_of_range, "radius", 512.5);
	refuse([](auto &bad) { bad.strength = -0.1; }, ErrorCode::out_of_range, "strength", -0.1);
	refuse([](auto &bad) { bad.strength = 1.1; }, ErrorCode::out_of_range, "strength", 1.1);
	refuse([](auto &bad) { bad.strength = nan_value; }, ErrorCode::not_finite, "strength", nan_value);
	refuse([](auto &bad) { bad.hardness = -0.1; }, ErrorCode::out_of_range, "hardness", -0.1);
	refuse([](auto &bad) { bad.hardness = 2.0; }, ErrorCode::out_of_range, "hardness", 2.0);
	refuse([](auto &bad) { bad.hardness = infinite_value; }, ErrorCode::not_finite, "hardness", infinite_value);
}

TEST_CASE("brush: the largest dab works in every mode, also at the end of the plane") {
	for (const Mode mode : {Mode::paint, Mode::erase, Mode::smooth}) {
		PaintedMask mask = mask_of(1.0, 0.5);
		const glm::dvec2 corner(PaintedMask::pixel_limit - 1025.0);
		const Rect changed_rect =
				paint(mask, {.mode = mode, .center = corner, .radius = max_brush_pixels, .hardness = 1.0});
		CHECK(changed_rect.empty() == (mode == Mode::smooth));
		CHECK(density(mask, corner) == (mode == Mode::smooth ? byte_density(128) : mode == Mode::paint ? 1.0f : 0.0f));
	}
}
