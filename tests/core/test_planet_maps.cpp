// Tests of painted masks and biome maps on planets.

#include "core/rules/biome_rules.hpp"
#include "core/rules/cube_grid.hpp"
#include "core/rules/density_expression.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/planet_cap.hpp"
#include "core/rules/rules.hpp"
#include "core/rules/sphere_image.hpp"
#include "mask_fixture.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <vector>

using namespace thicket;

namespace {

const Planet planet{{40.0, -30.0, 20.0}, 300.0};

glm::dvec3 random_direction(std::mt19937 &r_random) {
	std::normal_distribution<double> number;
	// Braces, because compilers evaluate the arguments of a function in different orders.
	return glm::normalize(glm::dvec3{number(r_random), number(r_random), number(r_random)});
}

/// Returns directions to the poles, the equator, and the corners, edges and faces of the cube.
std::vector<glm::dvec3> notable_directions() {
	std::vector<glm::dvec3> result;
	for (int i = 0; i < 27; ++i) {
		if (i != 13) {
			result.push_back(glm::normalize(glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
		}
	}
	result.push_back(glm::normalize(glm::dvec3(0.3, -0.9, 0.2)));
	result.push_back(glm::normalize(glm::dvec3(1.0, 0.97, 0.3)));
	return result;
}

/// Returns a direction at a distance on the sphere, in a direction of the compass.
glm::dvec3 beside(const glm::dvec3 &up, double meters, double bearing) {
	const glm::dvec3 side =
			glm::normalize(glm::cross(up, std::abs(up.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1)));
	const glm::dvec3 direction = std::cos(bearing) * side + std::sin(bearing) * glm::cross(up, side);
	const double angle = meters / planet.radius;
	return std::cos(angle) * up + std::sin(angle) * direction;
}

/// Returns the position at the planet's radius plus an altitude, as a batch's parts.
struct OnPlanet {
	explicit OnPlanet(const glm::dvec3 &direction, double altitude = 0.0) {
		const glm::dvec3 at = planet.center + (planet.radius + altitude) * direction;
		position = {at.x, at.z};
		height = static_cast<float>(at.y);
	}
	PositionBatch batch() const { return {{&position, 1}, {&height, 1}}; }

	glm::dvec2 position{};
	float height = 0.0F;
};

template <class Map>
float density_toward(const Map &map, const glm::dvec3 &direction, double altitude = 0.0) {
	const OnPlanet at(direction, altitude);
	float value = -1.0F;
	REQUIRE(map.sample_on(planet, at.batch(), {&value, 1}).ok());
	return value;
}

bool paint_toward(PaintedMask &r_mask, const glm::dvec3 &direction, const Brush &brush) {
	bool is_changed = false;
	REQUIRE(r_mask.paint_on(planet.radius, direction, brush, is_changed).ok());
	return is_changed;
}

/// Returns a mask with random dabs in all modes, all over the planet.
PaintedMask painted_planet(unsigned seed) {
	PaintedMask mask = mask_of(2.0, 0.5);
	std::mt19937 random(seed);
	for (int i = 0; i < 120; ++i) {
		paint_toward(mask, random_direction(random),
				{.mode = static_cast<Brush::Mode>(i % 3), .radius = 5.0 + i % 60, .strength = 0.7});
	}
	return mask;
}

/// Returns a map of 16 by 8 squares of 8 by 8 pixels, with biomes 0 to 3.
std::shared_ptr<const BiomeMap> biomes(const BiomeBorders &borders, std::uint8_t patch = 2) {
	std::vector<std::uint8_t> squares(16 * 8);
	for (std::size_t i = 0; i < squares.size(); ++i) {
		squares[i] = static_cast<std::uint8_t>(i / 16 % 2 ^ i / 4 % 2);
	}
	squares[5 * 16] = patch;
	squares[7 * 16 + 3] = 3;
	std::vector<std::uint8_t> pixels;
	for (std::size_t i = 0; i < 128 * 64; ++i) {
		pixels.push_back(squares[i / 1024 * 16 + i / 8 % 16]);
	}
	auto map = std::make_shared<BiomeMap>();
	REQUIRE(map->set({128, 64}, pixels, {{0.0, 0.0}, {1.0, 1.0}}, BiomeEdge::nothing, borders).ok());
	return map;
}

PerBiome<float> four_densities() {
	PerBiome<float> result{};
	std::ranges::copy(std::array{0.0F, 0.4F, 0.7F, 1.0F}, result.begin());
	return result;
}

} // namespace

TEST_CASE("planet maps: the directions of nodes are where the grid finds them, also beyond an edge") {
	for (const double pixel_size : {400.0, 30.0, 1.0, 1.0 / 64.0}) {
		const CubeGrid grid(planet.radius, pixel_size);
		CHECK(grid.count() % 2 == 1);
		CHECK(grid.count() * pixel_size < planet.radius * std::numbers::pi / 2.0 + pixel_size);
		std::mt19937 random(1);
		for (int i = 0; i < 3000; ++i) {
			const CubeGrid::Place cell = grid.at(random_direction(random));
			const glm::dvec2 tangents(grid.tangent(cell.position.x), grid.tangent(cell.position.y));
			const CubeGrid::Place inverse = grid.at(CubeGrid::direction(cell.face, tangents));
			REQUIRE(inverse.face == cell.face);
			REQUIRE(glm::distance(inverse.position, cell.position) < 1e-8 * grid.count());
			REQUIRE(cell.position.x >= 0.0);
			REQUIRE(cell.position.x <= grid.count());
			REQUIRE(cell.position.y >= 0.0);
			REQUIRE(cell.position.y <= grid.count());
		}
	}
}

TEST_CASE("planet maps: faces share the nodes of their edges, and every node has its own pixel") {
	const CubeGrid grid(planet.radius, 60.0);
	using Cell = std::tuple<int, int, int>;
	std::map<std::pair<int, int>, Cell> cells; // The rounded direction of each pixel.
	std::size_t stored_count = 0;
	for (int face = 0; face < CubeGrid::faces; ++face) {
		for (int y = 0; y <= grid.count(); ++y) {
			for (int x = 0; x <= grid.count(); ++x) {
				const glm::ivec2 pixel = grid.pixel(face, {x, y});
				const glm::dvec3 at = glm::round(1e6 * CubeGrid::direction(face, {grid.tangent(x), grid.tangent(y)}));
				const Cell cell(static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z));
				const auto first_cell = cells.emplace(std::pair(pixel.x, pixel.y), cell).first;
				REQUIRE(first_cell->second == cell);
				stored_count += grid.stores(face, {x, y}) ? 1 : 0;
				REQUIRE((grid.stores(face, {x, y}) == (pixel == grid.corner(face) + glm::ivec2(x, y))));
			}
		}
	}
	const auto count = static_cast<std::size_t>(grid.count());
	CHECK(cells.size() == 6 * count * count + 2);
	CHECK(stored_count == cells.size());
}

TEST_CASE("planet maps: near the pole toward +y, a mask has the same densities as on the ground") {
	PaintedMask mask = noisy_mask(1.0, 4);
	for (const glm::dvec2 at : {glm::dvec2(0.0), glm::dvec2(1.7, -0.4), glm::dvec2(-2.2, 3.1)}) {
		const glm::dvec3 direction = glm::normalize(glm::dvec3(at.x, planet.radius, at.y));
		CHECK(density_toward(mask, direction) == doctest::Approx(density(mask, at)).epsilon(0.02));
	}
}

TEST_CASE("planet maps: dabs are round on the ground at poles, at the equator and where faces meet") {
	for (const double radius : {6.0, 25.0, 90.0}) {
		for (const glm::dvec3 &center : notable_directions()) {
			PaintedMask mask = mask_of(0.5, 0.0);
			CHECK(paint_toward(mask, center, {.radius = radius, .hardness = 0.5}));
			CHECK(density_toward(mask, center) == 1.0F);
			for (int side = 0; side < 24; ++side) {
				// The strength is a half at three quarters of the radius.
				double within = 0.5 * radius;
				double outer = 1.1 * radius;
				for (int step = 0; step < 30; ++step) {
					const double middle = 0.5 * (within + outer);
					const glm::dvec3 at = beside(center, middle, side * std::numbers::pi / 12.0);
					(density_toward(mask, at) >= 0.5F ? within : outer) = middle;
				}
				REQUIRE(within > 0.75 * radius * 0.97);
				REQUIRE(within < 0.75 * radius * 1.03);
			}
		}
	}
}

TEST_CASE("planet maps: a dab changes nothing beyond its radius, on the other side, and outside its pixels") {
	for (const glm::dvec3 &center : notable_directions()) {
		PaintedMask mask = painted_planet(3);
		const PaintedMask before = mask;
		const double radius = 40.0;
		const auto rects = mask.pixels_on(planet.radius, center, radius);
		std::vector<std::vector<std::uint8_t>> undo;
		for (const PixelRect &rect : rects) {
			undo.push_back(read(mask, rect));
		}
		CHECK(paint_toward(mask, center, {.mode = Brush::Mode::erase, .radius = radius}));
		std::mt19937 random(7);
		for (int i = 0; i < 4000; ++i) {
			const glm::dvec3 at = random_direction(random);
			if (planet.radius * glm::distance(at, center) > radius + 4.0) {
				REQUIRE(density_toward(mask, at) == density_toward(before, at));
			}
		}
		for (std::size_t face = 0; face < rects.size(); ++face) {
			write(mask, rects[face], undo[face]);
		}
		CHECK((mask == before));
	}
}

TEST_CASE("planet maps: a painted mask is continuous everywhere") {
	const PaintedMask mask = painted_planet(5);
	std::mt19937 random(9);
	std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
	const double step = 1e-4; // Meters. Between nodes, which are 1.4 m or more apart, the density changes by 1 at most.
	for (int i = 0; i < 20000; ++i) {
		glm::dvec3 at = random_direction(random);
		if (i % 2 == 0) {
			// To an edge of the cube, where two components are equal.
			const int axis = i / 2 % 3;
			at[(axis + 1) % 3] = std::copysign(at[axis], at[(axis + 1) % 3]);
			at = glm::normalize(at);
		}
		const float density = density_toward(mask, beside(at, step, turn(random)), 500.0);
		const float opposite_density = density_toward(mask, beside(at, step, turn(random)), -250.0);
		REQUIRE(std::abs(density - opposite_density) < 4e-4F);
	}
}

TEST_CASE("planet maps: smoothing crosses edges, and keeps an even density") {
	for (const glm::dvec3 &center : notable_directions()) {
		PaintedMask even = mask_of(1.0, 0.3);
		CHECK_FALSE(paint_toward(even, center, {.mode = Brush::Mode::smooth, .radius = 30.0}));
		PaintedMask mask = mask_of(1.0, 0.0);
		paint_toward(mask, center, {.radius = 15.0, .hardness = 1.0});
		for (int i = 0; i < 6; ++i) {
			paint_toward(mask, center, {.mode = Brush::Mode::smooth, .radius = 40.0});
		}
		for (int side = 0; side < 8; ++side) {
			const float value = density_toward(mask, beside(center, 15.0, side * std::numbers::pi / 4.0 + 0.1));
			CHECK(value > 0.2F);
			CHECK(value < 0.8F);
		}
	}
}

TEST_CASE("planet maps: a dab of any size is valid, on a planet that is smaller than a pixel, too") {
	for (const double radius : {1e-3, 1.0, 1e5, 1e6, 1e9}) {
		PaintedMask mask = mask_of(1.0, 0.0);
		for (const double dab : {0.01, 3.0, 300.0}) {
			for (const auto mode : {Brush::Mode::paint, Brush::Mode::smooth}) {
				bool is_changed = false;
				CHECK(mask.paint_on(radius, {-1.0, 0.2, 0.9}, {.mode = mode, .radius = dab}, is_changed).ok());
			}
		}
		const Planet small{{0.0, 0.0, 0.0}, radius};
		const glm::dvec3 at = radius * glm::normalize(glm::dvec3(-1.0, 0.2, 0.9));
		const glm::dvec2 position(at.x, at.z);
		const auto height = static_cast<float>(at.y);
		float value = 0.0F;
		CHECK(mask.sample_on(small, {{&position, 1}, {&height, 1}}, {&value, 1}).ok());
		CHECK(value == 1.0F);
	}
}

TEST_CASE("planet maps: invalid dabs name the value and change nothing") {
	PaintedMask mask = mask_of(1.0, 0.0);
	bool is_changed = false;
	CHECK(std::string(mask.paint_on(0.0, {0.0, 1.0, 0.0}, {}, is_changed).property) == "planet_radius");
	CHECK(std::string(mask.paint_on(10.0, {0.0, 0.0, 0.0}, {}, is_changed).property) == "from_center");
	CHECK(std::string(mask.paint_on(10.0, {0.0, nan_value, 0.0}, {}, is_changed).property) == "from_center");
	CHECK(std::string(mask.paint_on(10.0, {0.0, 1.0, 0.0}, {.radius = 1e4}, is_changed).property) == "radius");
	CHECK(mask.block_count() == 0);
}

TEST_CASE("planet maps: caps contain the directions of a tile, and their shadows all instances toward them") {
	std::mt19937 random(11);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	int bounded = 0;
	for (int i = 0; i < 3000; ++i) {
		const glm::dvec3 middle = planet.center + planet.radius * (0.5 + unit(random)) * random_direction(random);
		const glm::dvec3 half = 60.0 * glm::dvec3(unit(random), unit(random), unit(random));
		const TileSpace space({{middle.x - half.x, middle.z - half.z}, {middle.x + half.x, middle.z + half.z}},
				middle.y - half.y, middle.y + half.y);
		const PlanetCap cap = cap_around(planet, space);
		const Rect shadow = shadow_of(planet, cap);
		bounded += shadow.finite() ? 1 : 0;
		for (int j = 0; j < 20; ++j) {
			const glm::dvec3 offset(2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0);
			const glm::dvec3 direction = planet.up_at(middle + half * offset);
			REQUIRE((cap.is_whole() || glm::length(glm::cross(direction, cap.middle)) <= cap.sine));
			const double farthest = 2.0 * planet.radius / std::max(std::abs(direction.y), 0.1);
			const glm::dvec3 at = planet.center + unit(random) * farthest * direction;
			REQUIRE((shadow.min.x <= at.x && at.x <= shadow.max.x));
			REQUIRE((shadow.min.y <= at.z && at.z <= shadow.max.y));
		}
	}
	CHECK(bounded > 1000);
	// A dab on the underside affects the columns below it, and not the whole planet.
	CHECK(shadow_of(planet, cap_within({0.0, -1.0, 0.0}, 10.0 / planet.radius)).size().x < 50.0);
}

TEST_CASE("planet maps: outside the areas of an edit, no density of a mask has changed") {
	std::mt19937 random(13);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	int changes = 0;
	int outside_count = 0;
	for (int round = 0; round < 60; ++round) {
		const PaintedMask before = painted_planet(6);
		PaintedMask after = before;
		const glm::dvec3 center = random_direction(random);
		paint_toward(after, center, {.mode = static_cast<Brush::Mode>(round % 2), .radius = 20.0});
		std::vector<Rect> areas;
		REQUIRE(after.find_edits_on(planet, before, areas));
		REQUIRE(!areas.empty());
		for (int i = 0; i < 300; ++i) {
			const glm::dvec3 at =
					i % 2 == 0 ? random_direction(random) : beside(center, 40.0 * unit(random), 7.0 * unit(random));
			const OnPlanet place(at, 200.0 * unit(random) - 100.0);
			const bool contained = std::ranges::any_of(
					areas, [&](const Rect &area) { return meet(area, {place.position, place.position}); });
			const bool differs = density_toward(before, at) != density_toward(after, at);
			REQUIRE((contained || !differs));
			changes += differs ? 1 : 0;
			outside_count += contained ? 0 : 1;
		}
	}
	CHECK(changes > 1000);
	CHECK(outside_count > 5000);
	std::vector<Rect> no_rects;
	CHECK(painted_planet(6).find_edits_on(planet, painted_planet(6), no_rects));
	CHECK(no_rects.empty());
	CHECK_FALSE(mask_of(1.0, 0.0).find_edits_on(planet, mask_of(1.0, 0.5), no_rects));
}

TEST_CASE("planet maps: a biome map covers the sphere like a texture") {
	const auto map = biomes({.width = 0.0, .noise = 0.0});
	// Columns go from +z over +x, and rows from +y down.
	CHECK(map->dominant_toward(planet.radius, {0.05, -0.6, 1.0}) == 2);
	CHECK(map->dominant_toward(planet.radius, {std::sin(1.37), -6.0, std::cos(1.37)}) == 3);
	CHECK(map->dominant_toward(planet.radius, {0.1, 1.0, 0.1}) == 0);
	CHECK(map->dominant_toward(planet.radius, {0.1, 1.0, -0.01}) == 1);
	BiomeTaps taps{};
	map->taps_toward(planet.radius, {infinite_value, 0.0, 0.0}, taps);
	CHECK(taps.front() == no_biome);
}

TEST_CASE("planet maps: a disc on an image contains the pixels within its radius, across the seam and at poles") {
	const glm::ivec2 image(200, 100);
	for (const glm::dvec3 &center : notable_directions()) {
		for (const double distance : {1e-6, 0.1, 0.7, 2.5}) {
			std::vector<PixelRect> rows;
			find_sphere_disc(image, center, distance, rows);
			std::vector<int> found(200 * 100, 0);
			for (const PixelRect &row : rows) {
				REQUIRE(row.size().y == 1);
				for (int x = row.min.x; x < row.max.x; ++x) {
					++found[static_cast<std::size_t>(row.min.y * 200 + x)];
				}
			}
			std::size_t wrong_count = 0;
			for (int i = 0; i < 200 * 100; ++i) {
				const double angle = (i % 200 + 0.5) / 100.0 * std::numbers::pi;
				const double from_pole = (i / 200 + 0.5) / 100.0 * std::numbers::pi;
				const glm::dvec3 at(std::sin(from_pole) * std::sin(angle), std::cos(from_pole),
						std::sin(from_pole) * std::cos(angle));
				const double center_distance = glm::distance(at, center);
				const int count = found[static_cast<std::size_t>(i)];
				wrong_count += count > 1 || (center_distance < distance - 1e-6 && count != 1) ? 1 : 0;
				wrong_count += count == 1 && center_distance > distance + 0.04
						? 1
						: 0; // The pixel of the center may be farther away.
			}
			CHECK(wrong_count == 0);
			const glm::dvec2 middle = sphere_image_position(center) * glm::dvec2(image);
			const int column = static_cast<int>(middle.x) % 200;
			const int row = std::min(static_cast<int>(middle.y), 99);
			CHECK(found[static_cast<std::size_t>(row * 200 + column)] == 1);
		}
	}
}

TEST_CASE("planet maps: borders of biomes are equally wide on every side") {
	const double width = 12.0;
	const auto map = biomes({.width = width, .noise = 0.0});
	PerBiome<float> set_biome{};
	set_biome[0] = 1.0F;
	const BiomeDensity layer(map, set_biome);
	// The equator is a border between rows. A meridian is a border at 80 degrees, where pixels are narrow.
	const auto mixed_length = [&](const glm::dvec3 &at, const glm::dvec3 &across) {
		int mixed = 0;
		for (int i = -400; i < 400; ++i) {
			const double angle = 0.05 * i / planet.radius;
			const float value = density_toward(layer, std::cos(angle) * at + std::sin(angle) * across);
			mixed += value > 0.0F && value < 1.0F ? 1 : 0;
		}
		return 0.05 * mixed;
	};
	CHECK(mixed_length(glm::normalize(glm::dvec3(1.0, 0.0, 0.4)), {0.0, 1.0, 0.0}) ==
			doctest::Approx(width).epsilon(0.1));
	const double pole = 80.0 * std::numbers::pi / 180.0;
	CHECK(mixed_length({std::cos(pole), std::sin(pole), 0.0}, {0.0, 0.0, 1.0}) == doctest::Approx(width).epsilon(0.1));
}

TEST_CASE("planet maps: the biomes of a cap include all biomes in it, across the seam and at poles") {
	const BiomeBorders borders{.width = 10.0, .noise = 15.0, .noise_size = 20.0};
	const auto map = biomes(borders);
	std::mt19937 random(17);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	int single = 0;
	for (int i = 0; i < 4000; ++i) {
		glm::dvec3 middle = random_direction(random);
		if (i % 4 == 0) {
			middle = glm::normalize(glm::dvec3(0.02 * middle.x, middle.y, std::abs(middle.z))); // Near the seam.
		}
		const double cap_radius = 0.3 * unit(random);
		const BiomeSet biome_set = map->biomes_toward(planet.radius, cap_within(middle, cap_radius));
		single += std::has_single_bit(biome_set) ? 1 : 0;
		for (int j = 0; j < 6; ++j) {
			BiomeTaps taps{};
			map->taps_toward(
					planet.radius, beside(middle, cap_radius * planet.radius * unit(random), 7.0 * unit(random)), taps);
			for (const std::uint8_t biome : taps) {
				REQUIRE((biome_set & biome_bit(biome)) != 0);
			}
		}
	}
	CHECK(single > 0);
}

TEST_CASE("planet maps: outside the areas of an edit, no density of a biome has changed") {
	const BiomeBorders borders{.width = 10.0, .noise = 15.0, .noise_size = 20.0};
	for (const int column : {0, 3, 8, 15}) {
		for (const int row : {0, 2, 4, 7}) {
			std::vector<std::uint8_t> pixels(16 * 8, 1);
			BiomeMap before;
			BiomeMap after;
			REQUIRE(before.set({16, 8}, pixels, {{0.0, 0.0}, {1.0, 1.0}}, BiomeEdge::nothing, borders).ok());
			pixels[static_cast<std::size_t>(row * 16 + column)] = 2;
			REQUIRE(after.set({16, 8}, pixels, {{0.0, 0.0}, {1.0, 1.0}}, BiomeEdge::nothing, borders).ok());
			std::vector<Rect> areas;
			REQUIRE(after.find_edits(before, four_densities(), four_densities(), areas, planet));
			REQUIRE(!areas.empty());
			std::mt19937 random(19);
			int changes = 0;
			for (int i = 0; i < 8000; ++i) { // A pixel at a pole has 0.2 % of all directions.
				const glm::dvec3 at = random_direction(random);
				const OnPlanet place(at);
				const bool contained = std::ranges::any_of(
						areas, [&](const Rect &area) { return meet(area, {place.position, place.position}); });
				const bool differs = after.dominant_toward(planet.radius, at) != 1;
				REQUIRE((contained || !differs));
				changes += differs ? 1 : 0;
			}
			CHECK(changes > 0);
		}
	}
}

TEST_CASE("planet maps: rules use the mask, the biome and the water of the side on which a point is") {
	PaintedMask mask = mask_of(1.0, 0.0);
	paint_toward(mask, {0.0, -1.0, 0.0}, {.radius = 50.0});
	const auto map = biomes({.width = 0.0, .noise = 0.0});
	PerBiome<double> levels{};
	levels.fill(no_water);
	levels[3] = 5.0;
	Rules rules;
	rules.mask = std::make_shared<PaintedMask>(mask);
	rules.biome = std::make_shared<BiomeDensity>(map, four_densities());
	rules.water = std::make_shared<WaterLevels>(map, levels);
	PreparedRules prepared_rules;
	REQUIRE(prepared_rules.set(rules, 1, GroundSides::all, planet).ok());
	std::vector<float> scratch;
	const auto position_density = [&](const glm::dvec3 &direction) {
		const OnPlanet at(direction);
		double value = -1.0;
		REQUIRE(prepared_rules.position_densities(at.batch(), {&value, 1}, scratch).ok());
		return value;
	};
	const glm::dvec3 bottom = glm::normalize(glm::dvec3(std::sin(1.37), -20.0, std::cos(1.37))); // In biome 3.
	const glm::dvec3 top(bottom.x, -bottom.y, bottom.z);
	CHECK(position_density(bottom) == 1.0);
	CHECK(position_density(top) == 0.0);
	const auto ground_density = [&](const glm::dvec3 &direction, double altitude) {
		const OnPlanet at(direction, altitude);
		return prepared_rules.ground_density({at.height, glm::vec3(direction)}, at.position);
	};
	CHECK(ground_density(bottom, 4.0) == 0.0);
	CHECK(ground_density(bottom, 6.0) == 1.0);
	CHECK(ground_density(top, 4.0) == 1.0);
	// Biome 2 is the only one of its layer, and it is on the side toward +z.
	PerBiome<float> second{};
	second[2] = 1.0F;
	rules.biome = std::make_shared<BiomeDensity>(map, second);
	REQUIRE(prepared_rules.set(rules, 1, GroundSides::all, planet).ok());
	const auto tile_at = [](const glm::dvec3 &direction) {
		const glm::dvec3 at = planet.center + planet.radius * glm::normalize(direction);
		return TileSpace({{at.x - 8.0, at.z - 8.0}, {at.x + 8.0, at.z + 8.0}}, at.y - 8.0, at.y + 8.0);
	};
	CHECK_FALSE(prepared_rules.closed_in(tile_at({0.2, -0.6, 1.0})));
	CHECK(prepared_rules.closed_in(tile_at({0.2, 0.6, 1.0})));
	CHECK(prepared_rules.closed_in(tile_at({0.2, -0.6, -1.0})));
}

TEST_CASE("planet maps: noise in expressions differs between the sides, and continues around the planet") {
	Rules rules;
	rules.max_slope_degrees = 180.0;
	ExpressionError error;
	rules.expression = DensityExpression::compile("noise(20)", error);
	REQUIRE(rules.expression != nullptr);
	PreparedRules prepared;
	REQUIRE(prepared.set(rules, 7, GroundSides::all, planet).ok());
	const auto density_at = [&prepared](const glm::dvec3 &up) {
		const glm::dvec3 position = planet.center + planet.radius * up;
		return prepared.ground_density({static_cast<float>(position.y), glm::vec3(up)}, {position.x, position.z});
	};
	std::mt19937 random(3);
	double angular_gap = 0.0;
	double step = 0.0;
	constexpr int count = 1000;
	for (int i = 0; i < count; ++i) {
		const glm::dvec3 up = random_direction(random);
		angular_gap += std::abs(density_at(up) - density_at({up.x, -up.y, up.z}));
		step = std::max(step, std::abs(density_at(up) - density_at(beside(up, 0.1, i))));
	}
	CHECK(angular_gap / count > 0.15); // Independent numbers from 0 to 1 differ by a third on average.
	CHECK(step < 0.1);
}
