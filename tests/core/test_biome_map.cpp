// Tests of biome maps: index images, borders between biomes, and the area that an edit affects.

#include "core/rules/biome_map.hpp"
#include "refusal.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;

namespace {

using Pixels = std::vector<std::uint8_t>;

/// 100 by 60 pixels of 2 by 3 meters around the origin: biome 0 on the left, biome 1 on the right,
/// a patch of biome 2, and a hole without a biome.
constexpr glm::ivec2 size{100, 60};
const Rect area{{-100.0, -90.0}, {100.0, 90.0}};
constexpr BiomeBorders bent{.width = 6.0, .noise = 8.0, .noise_size = 30.0, .seed = 7};

Pixels image() {
	Pixels pixels;
	for (int y = 0; y < size.y; ++y) {
		for (int x = 0; x < size.x; ++x) {
			const bool patch = x >= 70 && x < 80 && y >= 20 && y < 30;
			const bool hole = x >= 10 && x < 20 && y >= 40;
			pixels.push_back(hole ? no_biome : patch ? 2 : x < 50 ? 0 : 1);
		}
	}
	return pixels;
}

BiomeMap map_of(const Pixels &pixels, const BiomeBorders &borders = {}, BiomeEdge edge = BiomeEdge::nothing) {
	BiomeMap map;
	REQUIRE(map.set(size, pixels, area, edge, borders).ok());
	return map;
}

std::uint8_t pixel_of(const Pixels &pixels, glm::dvec2 at, BiomeEdge edge) {
	const int x = static_cast<int>(std::floor((at.x + 100.0) / 2.0));
	const int y = static_cast<int>(std::floor((at.y + 90.0) / 3.0));
	if (edge == BiomeEdge::nothing && (x < 0 || y < 0 || x >= size.x || y >= size.y)) {
		return no_biome;
	}
	return pixels[static_cast<std::size_t>(std::clamp(y, 0, size.y - 1) * size.x + std::clamp(x, 0, size.x - 1))];
}

std::vector<glm::dvec2> random_positions(int count, unsigned seed = 1, double extent = 140.0) {
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> along(-extent, extent);
	std::vector<glm::dvec2> result;
	for (int i = 0; i < count; ++i) {
		result.emplace_back(along(random), along(random));
	}
	return result;
}

BiomeTaps taps(const BiomeMap &map, glm::dvec2 at) {
	BiomeTaps result{};
	map.taps_at(at, result);
	return result;
}

double weight(const BiomeMap &map, glm::dvec2 at, std::uint8_t biome) {
	return static_cast<double>(std::ranges::count(taps(map, at), biome)) / biome_taps;
}

PerBiome<float> density_of(std::initializer_list<float> values) {
	PerBiome<float> result{};
	std::ranges::copy(values, result.begin());
	return result;
}

} // namespace

TEST_CASE("biome map: without borders, positions have the biome of their pixel, or of the edge mode outside") {
	for (const BiomeEdge edge : {BiomeEdge::nothing, BiomeEdge::clamp}) {
		const Pixels pixels = image();
		const BiomeMap map = map_of(pixels, {}, edge);
		for (const glm::dvec2 at : random_positions(4000)) {
			CAPTURE(at.x);
			CAPTURE(at.y);
			CHECK(map.dominant_at(at) == pixel_of(pixels, at, edge));
			CHECK(weight(map, at, pixel_of(pixels, at, edge)) == 1.0);
		}
	}
}

TEST_CASE("biome map: a border mixes two biomes evenly over exactly its width, in any direction") {
	const BiomeMap map = map_of(image(), {.width = 20.0});
	for (double x = -15.0; x <= 15.0; x += 0.25) {
		const double expected = std::clamp(0.5 + x / 20.0, 0.0, 1.0);
		CHECK(std::abs(weight(map, {x, 0.0}, 1) - expected) <= 1.0 / 32.0);
		CHECK(weight(map, {x, 0.0}, 0) == 1.0 - weight(map, {x, 0.0}, 1));
	}
	CHECK(weight(map, {-10.01, 0.0}, 1) == 0.0);
	CHECK(weight(map, {10.01, 0.0}, 0) == 0.0);
}

TEST_CASE("biome map: noise moves a border by at most its strength, to both sides, depending on its seed") {
	const Pixels pixels = image();
	const BiomeMap straight = map_of(pixels);
	const BiomeMap wavy = map_of(pixels, {.noise = 8.0, .noise_size = 30.0, .seed = 7});
	const BiomeMap other = map_of(pixels, {.noise = 8.0, .noise_size = 30.0, .seed = 8});
	int to_left = 0;
	int to_right = 0;
	int other_by_seed = 0;
	for (double y = -80.0; y < 20.0; y += 0.5) {
		CHECK(wavy.dominant_at({-8.1, y}) == 0);
		CHECK(wavy.dominant_at({8.1, y}) == 1);
		to_left += wavy.dominant_at({-1.0, y}) == 1 ? 1 : 0;
		to_right += wavy.dominant_at({1.0, y}) == 0 ? 1 : 0;
		other_by_seed += wavy.dominant_at({0.5, y}) != other.dominant_at({0.5, y}) ? 1 : 0;
		CHECK(straight.dominant_at({-0.1, y}) == 0);
	}
	CHECK(to_left > 20);
	CHECK(to_right > 20);
	CHECK(other_by_seed > 20);
}

TEST_CASE("biome map: the biomes of a rectangle are complete, and only one biome is listed away from borders") {
	for (const BiomeEdge edge : {BiomeEdge::nothing, BiomeEdge::clamp}) {
		const BiomeMap map = map_of(image(), bent, edge);
		std::mt19937 random(3);
		std::uniform_real_distribution<double> side(0.0, 60.0);
		std::uniform_real_distribution<double> part(0.0, 1.0);
		for (const glm::dvec2 corner : random_positions(200, 2)) {
			const Rect rect{corner, corner + glm::dvec2(side(random), side(random))};
			const BiomeSet set = map.biomes_in(rect);
			for (int i = 0; i < 50; ++i) {
				const glm::dvec2 at = rect.min + glm::dvec2(part(random), part(random)) * rect.size();
				for (const std::uint8_t biome : taps(map, at)) {
					CHECK((set & biome_bit(biome)) != 0);
				}
			}
		}
		CHECK(map.biomes_in({{-80.0, -60.0}, {-60.0, -20.0}}) == biome_bit(0));
		const BiomeSet outside_biomes = edge == BiomeEdge::nothing ? biome_bit(no_biome) : biome_bit(1);
		CHECK(map.biomes_in({{500.0, -60.0}, {600.0, -20.0}}) == outside_biomes);
		CHECK(map.biomes_in({{-infinite_value, 0.0}, {infinite_value, 1.0}}) ==
				(biome_bit(0) | biome_bit(1) | biome_bit(2) | biome_bit(no_biome)));
	}
}

TEST_CASE("biome map: bit-identical on every machine") {
	const BiomeMap map = map_of(image(), bent, BiomeEdge::clamp);
	std::uint64_t digest = 0;
	for (int y = -90; y < 90; y += 3) {
		for (int x = -40; x < 40; ++x) {
			for (const std::uint8_t biome : taps(map, {x * 0.37, y * 1.01})) {
				digest = digest * 1099511628211U + biome;
			}
		}
	}
	CHECK(digest == 11745592883742851120U);
}

TEST_CASE("biome map: positions that are not finite have no biome") {
	const BiomeMap map = map_of(image(), bent, BiomeEdge::clamp);
	for (const glm::dvec2 at :
			{glm::dvec2(nan_value, 0.0), glm::dvec2(0.0, nan_value), glm::dvec2(infinite_value, 0.0)}) {
		CHECK(map.dominant_at(at) == no_biome);
	}
	CHECK(map.dominant_at({1e300, 0.0}) == 1);
	CHECK(BiomeMap().dominant_at({0.5, 0.5}) == no_biome);
}

TEST_CASE("biome map: rejects invalid images and borders, and stays unchanged") {
	BiomeMap map = map_of(image());
	const BiomeMap before = map;
	const Pixels pixels = image();
	const Pixels single_pixel{0};
	const auto set = [&map](glm::ivec2 resolution, const Pixels &given, const Rect &rect, const BiomeBorders &borders) {
		return map.set(resolution, given, rect, BiomeEdge::clamp, borders);
	};
	check_refused(set({0, 1}, {}, area, {}), ErrorCode::out_of_range, "size", 0.0);
	check_refused(set({1, max_biome_map_pixels + 1}, {}, area, {}), ErrorCode::out_of_range, "size", 8193.0);
	check_refused(set({2, 1}, single_pixel, area, {}), ErrorCode::wrong_size, "pixels", 1.0);
	check_refused(set({1, 1}, {32}, area, {}), ErrorCode::out_of_range, "pixels", 32.0);
	check_refused(set({1, 1}, single_pixel, {{0.0, 0.0}, {0.0, 1.0}}, {}), ErrorCode::not_positive, "rect", 0.0);
	check_refused(set({1, 1}, single_pixel, area, {.width = -1.0}), ErrorCode::out_of_range, "border_width", -1.0);
	check_refused(set({1, 1}, single_pixel, area, {.noise = 2e4}), ErrorCode::out_of_range, "border_noise", 2e4);
	check_refused(
			set({1, 1}, single_pixel, area, {.noise_size = 0.5}), ErrorCode::out_of_range, "border_noise_size", 0.5);
	check_refused(set({1, 1}, single_pixel, area, {.width = infinite_value}), ErrorCode::not_finite, "border_width",
			infinite_value);
	CHECK(map == before);
	CHECK(map == map_of(pixels));
}

TEST_CASE("edits of a biome map: nothing changes outside of the edited areas, which are small") {
	const Pixels before_pixels = image();
	Pixels after_pixels = before_pixels;
	for (int y = 10; y < 14; ++y) {
		for (int x = 30; x < 36; ++x) {
			after_pixels[static_cast<std::size_t>(y * size.x + x)] = 2;
		}
	}
	const BiomeMap before = map_of(before_pixels, bent);
	const BiomeMap after = map_of(after_pixels, bent);
	const auto values = density_of({0.5F, 1.0F, 0.25F});
	std::vector<Rect> areas;
	REQUIRE(after.find_edits(before, values, values, areas));
	double edited = 0.0;
	for (const Rect &rect : areas) {
		edited += rect.size().x * rect.size().y;
	}
	// The changed pixels cover 12 x 12 m, and each piece extends 11 m beyond them.
	CHECK(edited < 4.0 * 34.2 * 34.2);
	for (const glm::dvec2 at : random_positions(20000, 5)) {
		const bool is_inside = std::ranges::any_of(areas, [at](const Rect &rect) { return rect.contains(at); });
		CHECK((is_inside || taps(before, at) == taps(after, at)));
	}
}

TEST_CASE("edits of a biome map: a changed value edits only its biome, an equal value nothing") {
	const BiomeMap map = map_of(image(), bent, BiomeEdge::clamp);
	const auto before = density_of({0.5F, 1.0F, 0.25F});
	std::vector<Rect> areas;
	REQUIRE(map.find_edits(map, before, before, areas));
	CHECK(areas.empty());
	REQUIRE(map.find_edits(map, before, density_of({0.5F, 1.0F, 0.75F}), areas));
	Rect all{glm::dvec2(infinite_value), glm::dvec2(-infinite_value)};
	for (const Rect &rect : areas) {
		all = united(all, rect);
	}
	// The patch and 11 m around it, but nothing beyond the map, although its edge is clamped.
	CHECK(all.min.x == doctest::Approx(40.0 - 11.0).epsilon(0.01));
	CHECK(all.max.x == doctest::Approx(60.0 + 11.0).epsilon(0.01));
	CHECK(all.min.y == doctest::Approx(-30.0 - 11.0).epsilon(0.01));
	CHECK(all.max.y == doctest::Approx(0.0 + 11.0).epsilon(0.01));
	areas.clear();
	REQUIRE(map.find_edits(map, before, density_of({0.0F, 1.0F, 0.25F}), areas));
	const auto touched = [&areas](glm::dvec2 at) {
		return std::ranges::any_of(areas, [at](const Rect &rect) { return rect.contains(at); });
	};
	CHECK(touched({-500.0, 0.0}));
	CHECK_FALSE(touched({500.0, 0.0}));
}

TEST_CASE("edits of a biome map: different borders or edges may change everything") {
	const BiomeMap map = map_of(image(), bent);
	const auto values = density_of({1.0F});
	std::vector<Rect> areas;
	BiomeBorders other = bent;
	other.seed = 8;
	CHECK_FALSE(map_of(image(), other).find_edits(map, values, values, areas));
	CHECK_FALSE(map_of(image(), bent, BiomeEdge::clamp).find_edits(map, values, values, areas));
	CHECK(areas.empty());
}

TEST_CASE("biome map: no noise is computed away from borders") {
	// At these positions, the coordinates in noise cells would overflow.
	const BiomeMap map = map_of(image(), {.width = 6.0, .noise = 8.0, .noise_size = 1.0}, BiomeEdge::clamp);
	for (const glm::dvec2 distant : {glm::dvec2(1e308, 0.0), glm::dvec2(-1e308, 20.0)}) {
		BiomeTaps taps{};
		CHECK_FALSE(test::overflows([&] { map.taps_at(distant, taps); }));
		CHECK(taps[0] == (distant.x > 0.0 ? 1 : 0));
	}
}
