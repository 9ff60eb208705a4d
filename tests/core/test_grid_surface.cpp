#include "core/terrain/heightfield.hpp"
#include "core/terrain/map_field.hpp"
#include "core/terrain/region_field.hpp"

#include <doctest/doctest.h>

#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;

namespace {

constexpr int side = 71; // More than two blocks, and not a multiple of their width.
constexpr HeightfieldFrame frame{{side, side - 20}, {{-30.0, 10.0}, {40.0, 160.0}}, -20.0, 80.0};

bool is_absent(const std::array<glm::dvec3, 3> &corners) {
	return corners[0] == corners[1] && corners[1] == corners[2];
}

std::vector<float> random_heights(std::size_t count, float low, float high, bool holes) {
	std::mt19937 random(5);
	std::vector<float> heights(count);
	for (float &height : heights) {
		height = std::uniform_real_distribution<float>(low, high)(random);
		height = holes && random() % 16 == 0 ? std::nanf("") : height;
	}
	return heights;
}

Heightfield field_of(const std::vector<float> &heights, FloatPosts meaning) {
	Heightfield field;
	const auto shared = std::make_shared<const std::vector<float>>(heights);
	REQUIRE(field.set_posts(frame, {{}, {frame.posts, shared}, meaning}).ok());
	return field;
}

/// A grid of `size` x `size` words of four bytes.
template <class Word>
PixelGrid grid_of(const std::vector<Word> &words, int size) {
	const auto owner = std::make_shared<std::vector<Word>>(words);
	PixelGrid grid;
	const auto *bytes = reinterpret_cast<const std::uint8_t *>(owner->data());
	REQUIRE(grid.set({size, size}, 4, {owner, {bytes, owner->size() * sizeof(Word)}}).ok());
	return grid;
}

/// Checks that all triangles face up and lie on the ground, and that searches find them. Returns the
/// number of triangles.
std::size_t check_surface(const Terrain &terrain, double twist) {
	const Surface *surface = terrain.surface();
	REQUIRE(surface != nullptr);
	std::vector<std::uint32_t> all;
	Box3 bounds = no_box;
	bool face_up = true;
	double farthest = 0.0;
	for (std::uint32_t index = 0; index < surface->triangle_count(); ++index) {
		const auto corners = surface->triangle(index);
		if (is_absent(corners)) {
			continue;
		}
		all.push_back(index);
		bounds = with(bounds, surface->triangle_bounds(index));
		face_up = face_up && surface->cross(index).y > 0.0;
		const glm::dvec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
		const double distance = std::abs(terrain.at({middle.x, middle.z}).height - middle.y);
		farthest = std::isnan(distance) ? 1e9 : std::max(farthest, distance);
	}
	CHECK(face_up);
	CHECK(farthest <= twist);
	CHECK(glm::all(glm::lessThanEqual(surface->bounds().min, bounds.min)));
	CHECK(glm::all(glm::greaterThanEqual(surface->bounds().max, bounds.max)));
	CHECK(surface->bounds().min.y == bounds.min.y);
	CHECK(surface->bounds().max.y == bounds.max.y);

	std::mt19937 random(3);
	std::vector<std::uint32_t> results;
	surface->find({bounds.min, bounds.max}, results);
	CHECK(results == all);
	for (int search = 0; search < 60; ++search) {
		Box3 box = no_box;
		for (int end = 0; end < 2; ++end) {
			glm::dvec3 at;
			for (int axis = 0; axis < 3; ++axis) {
				const double margin = 0.1 * (bounds.max[axis] - bounds.min[axis]);
				at[axis] = std::uniform_real_distribution<double>(bounds.min[axis] - margin, bounds.max[axis] + margin)(
						random);
			}
			box = with(box, at);
		}
		box.max = search % 3 == 0 ? box.min : box.max;
		surface->find(box, results);
		std::vector<std::uint32_t> expected;
		std::ranges::copy_if(all, std::back_inserter(expected),
				[&](std::uint32_t index) { return touch(surface->triangle_bounds(index), box); });
		CHECK(results == expected);
	}
	const double infinity = std::numeric_limits<double>::infinity();
	surface->find({glm::dvec3(-infinity), glm::dvec3(infinity)}, results);
	CHECK(results == all);
	surface->find({glm::dvec3(std::nan("")), glm::dvec3(std::nan(""))}, results);
	CHECK(results.empty());
	return all.size();
}

} // namespace

TEST_CASE("grid surface: a heightfield of 16-bit samples has two triangles for each patch and is updated by patches") {
	std::vector<std::uint16_t> posts(static_cast<std::size_t>(frame.posts.x) * static_cast<std::size_t>(frame.posts.y));
	std::mt19937 random(8);
	std::ranges::generate(posts, [&] { return static_cast<std::uint16_t>(random()); });
	Heightfield field;
	CHECK(field.surface() == nullptr);
	REQUIRE(field.set(frame, posts).ok());
	const std::size_t patches =
			static_cast<std::size_t>(frame.posts.x - 1) * static_cast<std::size_t>(frame.posts.y - 1);
	CHECK(check_surface(field, 50.0) == 2 * patches);
	const Heightfield before = field;
	const std::vector<std::uint16_t> high(4, 65535);
	REQUIRE(field.patch({{10, 12}, {12, 14}}, high).ok());
	CHECK(check_surface(field, 50.0) == 2 * patches);
	CHECK(field.surface()->triangle(2 * (12 * (frame.posts.x - 1) + 10))[0].y == doctest::Approx(80.0));
	CHECK(before.surface()->triangle(2 * (12 * (frame.posts.x - 1) + 10))[0].y < 79.9);
}

TEST_CASE("grid surface: float samples in meters or units, without the patches around holes") {
	const std::size_t count = static_cast<std::size_t>(frame.posts.x) * static_cast<std::size_t>(frame.posts.y);
	for (const FloatPosts meaning : {FloatPosts::meters, FloatPosts::units}) {
		const float high = meaning == FloatPosts::meters ? 6.0f : 1.0f;
		const std::vector<float> heights = random_heights(count, 0.0f, high, true);
		const Heightfield field = field_of(heights, meaning);
		std::size_t whole_count = 0;
		for (int row = 0; row + 1 < frame.posts.y; ++row) {
			for (int column = 0; column + 1 < frame.posts.x; ++column) {
				const float *first = &heights[static_cast<std::size_t>(row * frame.posts.x + column)];
				whole_count +=
						std::isnan(first[0] + first[1] + first[frame.posts.x] + first[frame.posts.x + 1]) ? 0 : 1;
			}
		}
		CHECK(check_surface(field, 50.0) == 2 * whole_count);
	}
	const Heightfield no_heights = field_of(std::vector<float>(count, std::nanf("")), FloatPosts::meters);
	CHECK(is_empty(no_heights.surface()->bounds()));
	CHECK(no_heights.surface()->area() == 0.0);
	std::vector<std::uint32_t> results{1};
	no_heights.surface()->find({glm::dvec3(-100.0), glm::dvec3(100.0)}, results);
	CHECK(results.empty());
}

TEST_CASE("grid surface: on an inclined plane, the area and the heights are exact") {
	std::vector<float> heights;
	for (int row = 0; row < frame.posts.y; ++row) {
		for (int column = 0; column < frame.posts.x; ++column) {
			heights.push_back(static_cast<float>(column)); // 45 degrees: the columns are 1 m apart.
		}
	}
	const Heightfield field = field_of(heights, FloatPosts::meters);
	CHECK(field.surface()->area() == doctest::Approx(70.0 * 150.0 * std::sqrt(2.0)));
	check_surface(field, 1e-5);
}

TEST_CASE("grid surface: regions without seams, holes and neighbors, at any offset") {
	constexpr int region_side = 40;
	constexpr std::size_t posts = region_side * region_side;
	std::vector<std::uint32_t> controls(posts, 0);
	controls[region_side * 5 + 5] = 4; // A hole.
	RegionField field;
	CHECK(field.surface() == nullptr);
	const PixelGrid heights = grid_of(random_heights(posts, -3.0f, 3.0f, false), region_side);
	const std::vector<FieldRegion> regions{
			{{0, 0}, heights, grid_of(controls, region_side)}, {{-1, 0}, heights, {}}, {{3, 2}, heights, {}}};
	REQUIRE(field.set(region_side, 1.5, regions, {}).ok());
	const std::size_t seam = region_side - 1;
	const std::size_t expected = 2 * (3 * seam * seam + seam) - 8;
	CHECK(check_surface(field, 4.0) == expected);
	CHECK(check_surface(field.at_offset({100.0, 20.0, -7.0}), 4.0) == expected);
	CHECK(field.at_offset({100.0, 20.0, -7.0}).surface()->bounds().min.y == field.surface()->bounds().min.y + 20.0);
	RegionField empty;
	REQUIRE(empty.set(region_side, 1.0, {}, {}).ok());
	CHECK(empty.surface() == nullptr);
}

TEST_CASE("grid surface: rotated and mirrored maps, without patches that touch a hole") {
	constexpr int map_side = 40;
	constexpr std::size_t posts = map_side * map_side;
	MapLayers layers;
	layers.heights = grid_of(random_heights(posts, -3.0f, 3.0f, false), map_side);
	std::vector<std::uint32_t> colors(posts, 0xffffffffu);
	colors[map_side * 7 + 9] = 0x00ffffffu;
	layers.colors = grid_of(colors, map_side);
	for (const glm::dmat2 &to_world : {glm::dmat2(1.0), glm::dmat2({0.8, 0.6}, {-0.6, 0.8}),
				 glm::dmat2({0.0, 2.0}, {3.0, 0.0}), glm::dmat2({-1.0, 0.0}, {0.0, 1.0})}) {
		MapField field;
		REQUIRE(field.set({to_world, {10.0, 5.0, -20.0}, 0.5}, layers).ok());
		const std::size_t expected = 2 * (map_side - 1) * (map_side - 1) - 8;
		CHECK(check_surface(field, 2.0) == expected);
		CHECK(check_surface(field.at_offset({7.0, 1.0, 3.0}), 2.0) == expected);
	}
}
