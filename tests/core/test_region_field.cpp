#include "core/terrain/region_field.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;

namespace {

constexpr int side = 16;

PixelGrid grid_of(const std::function<std::uint32_t(glm::ivec2)> &word_at, int of = side) {
	auto words = std::make_shared<std::vector<std::uint32_t>>();
	for (int row = 0; row < of; ++row) {
		for (int column = 0; column < of; ++column) {
			words->push_back(word_at({column, row}));
		}
	}
	const auto *bytes = reinterpret_cast<const std::uint8_t *>(words->data());
	PixelGrid grid;
	REQUIRE(grid.set(glm::ivec2(of), 4, {words, {bytes, words->size() * 4}}).ok());
	return grid;
}

/// The height and the control bits of each sample of the world.
struct World {
	std::function<float(glm::ivec2)> height = [](glm::ivec2 post) {
		return 3.0F * std::sin(0.4F * static_cast<float>(post.x)) + 0.05F * static_cast<float>(post.y * post.y % 61);
	};
	std::function<std::uint32_t(glm::ivec2)> control = [](glm::ivec2) {
		return 0u;
	};
	std::vector<glm::ivec2> locations{{-1, -1}, {0, -1}, {-1, 0}, {0, 0}, {3, 1}};

	bool has(glm::ivec2 post) const {
		const glm::ivec2 at{static_cast<int>(std::floor(post.x / double(side))),
				static_cast<int>(std::floor(post.y / double(side)))};
		return std::ranges::find(locations, at) != locations.end();
	}

	/// Returns the height by the definition of RegionField, computed without its optimizations.
	float height_at(glm::dvec2 position, double spacing) const {
		const glm::dvec2 posts = position / spacing;
		const glm::ivec2 first{static_cast<int>(std::floor(posts.x)), static_cast<int>(std::floor(posts.y))};
		const glm::dvec2 fraction = posts - glm::dvec2(first);
		double sum = 0.0;
		for (int corner = 0; corner < 4; ++corner) {
			const glm::ivec2 step{corner % 2, corner / 2};
			const glm::ivec2 post = first + step;
			if (!has(post) || (control(post) & 4u) != 0) {
				return std::numeric_limits<float>::quiet_NaN();
			}
			sum += height(post) * (step.x != 0 ? fraction.x : 1.0 - fraction.x) *
					(step.y != 0 ? fraction.y : 1.0 - fraction.y);
		}
		return static_cast<float>(sum);
	}

	RegionField field(double spacing = 1.0, const AutoPaint &paint = {}) const {
		std::vector<FieldRegion> regions;
		for (const glm::ivec2 at : locations) {
			regions.push_back({at,
					grid_of([&](glm::ivec2 post) { return std::bit_cast<std::uint32_t>(height(post + at * side)); }),
					grid_of([&](glm::ivec2 post) { return control(post + at * side); })});
		}
		RegionField field;
		REQUIRE(field.set(side, spacing, regions, paint).ok());
		return field;
	}
};

constexpr std::uint32_t control_of(unsigned base, unsigned overlay, unsigned blend) {
	return base << 27u | overlay << 22u | blend << 14u;
}

float weight(const RegionField &field, glm::dvec2 position, std::vector<std::int32_t> textures) {
	Ground ground;
	REQUIRE(field.weigh({&position, 1}, textures, {&ground, 1}).ok());
	return ground.weight;
}

} // namespace

TEST_CASE("region field: heights are bilinear, without seams between regions, and a missing sample is a hole") {
	World world;
	world.control = [](glm::ivec2 post) {
		return post == glm::ivec2(-3, 4) || post == glm::ivec2(0, 0) ? 4u : 0u;
	};
	std::mt19937 random(1);
	std::uniform_real_distribution<double> along(-20.0, 70.0);
	for (const double spacing : {0.3, 1.0, 7.5}) {
		const RegionField field = world.field(spacing);
		int ground = 0;
		for (int i = 0; i < 20000; ++i) {
			const glm::dvec2 position = glm::dvec2(along(random), along(random)) * spacing;
			const float expected = world.height_at(position, spacing);
			const float height = field.at(position).height;
			REQUIRE(std::isnan(height) == std::isnan(expected));
			if (!std::isnan(height)) {
				REQUIRE(std::abs(height - expected) < 1e-5F);
				++ground;
			}
		}
		CHECK(ground > 1500);
	}
	const RegionField field = world.field();
	CHECK(field.at({5.0, -3.0}).height == world.height({5, -3}));
	CHECK(std::isnan(field.at({15.5, 3.0}).height)); // There is no sample after the last one to interpolate with.
	for (const double coordinate : {1e9, -1e30, std::numeric_limits<double>::infinity(), std::nan("")}) {
		CHECK(std::isnan(field.at({coordinate, 0.0}).height));
	}
}

TEST_CASE("region field: normals equal Terrain3D's, from the heights of the next samples") {
	const World world;
	const double spacing = 2.0;
	const RegionField field = world.field(spacing);
	std::mt19937 random(2);
	std::uniform_real_distribution<double> along(-31.0, 26.0);
	for (int i = 0; i < 5000; ++i) {
		const glm::dvec2 at{along(random), along(random)};
		const double here = world.height_at(at, spacing);
		const double x = here - world.height_at(at + glm::dvec2(spacing, 0.0), spacing);
		const double z = here - world.height_at(at + glm::dvec2(0.0, spacing), spacing);
		const glm::vec3 expected(glm::normalize(glm::dvec3(x, spacing, z)));
		REQUIRE(glm::distance(field.at(at).normal, expected) < 1e-5F);
	}
	World plane;
	plane.height = [](glm::ivec2 post) {
		return 0.5F * static_cast<float>(post.x) - 0.25F * static_cast<float>(post.y);
	};
	plane.control = [](glm::ivec2 post) {
		return post.x == 8 ? 4u : 0u;
	};
	const glm::vec3 slope = glm::normalize(glm::vec3(-0.5F, 1.0F, 0.25F));
	for (const glm::dvec2 at : {glm::dvec2(14.5, 14.5), glm::dvec2(6.5, 3.0), glm::dvec2(-16.0, -16.0)}) {
		// The normal is also correct near the border and near holes.
		CHECK(glm::distance(plane.field().at(at).normal, slope) < 1e-6F);
	}
}

TEST_CASE("region field: the previous sample's control bits determine the textures, painted by hand or by slope and "
		  "height") {
	World world;
	world.height = [](glm::ivec2 post) {
		return static_cast<float>(post.x);
	};
	world.control = [](glm::ivec2 post) {
		return post.x < 0 ? control_of(3, 31, 51) : post.y < 0 ? control_of(5, 5, 128) : control_of(7, 8, 255) | 1u;
	};
	const RegionField field = world.field();
	CHECK(weight(field, {-2.5, 4.0}, {3}) == doctest::Approx(0.8));
	CHECK(weight(field, {-2.5, 4.0}, {31}) == doctest::Approx(0.2));
	CHECK(weight(field, {-2.5, 4.0}, {1, 31, 3}) == doctest::Approx(1.0));
	CHECK(weight(field, {-2.5, 4.0}, {4, -3}) == 0.0F);
	CHECK(weight(field, {-0.01, 4.0}, {31}) == doctest::Approx(0.2));
	CHECK(weight(field, {2.0, -5.0}, {5}) == doctest::Approx(1.0));
	CHECK(weight(field, {2.0, 5.0}, {8}) == 1.0F); // The sample is set to auto, but the auto shader is off.
	const AutoPaint paint{true, 1, 2, 0.5, 4.0};
	const RegionField painted = world.field(1.0, paint);
	const double overlay = 0.5 * 2.0 * (1.0 / std::sqrt(2.0) - 1.0) + 1.0 - 4.0 * 0.01 * 6.25;
	CHECK(weight(painted, {6.25, 5.0}, {8, 31}) == 0.0F);
	CHECK(weight(painted, {6.25, 5.0}, {2}) == doctest::Approx(overlay));
	CHECK(weight(painted, {6.25, 5.0}, {1}) == doctest::Approx(1.0 - overlay));
	CHECK(weight(painted.at_offset({64.0, 100.0, -32.0}), {70.25, -27.0}, {2}) == doctest::Approx(overlay));
	CHECK(weight(painted, {-2.5, 4.0}, {31}) == doctest::Approx(0.2)); // This texture is painted by hand.
}

TEST_CASE("region field: a field may be moved in the world, and may have no regions") {
	const World world;
	const RegionField field = world.field();
	const glm::dvec3 offset{1e6, 250.0, -3e5};
	const RegionField shifted = field.at_offset(offset);
	const glm::dvec2 at{3.25, -7.5};
	CHECK(shifted.at(at + glm::dvec2(offset.x, offset.z)).height == doctest::Approx(field.at(at).height + 250.0));
	CHECK(shifted.at(at + glm::dvec2(offset.x, offset.z)).normal == field.at(at).normal);
	RegionField empty;
	CHECK(std::isnan(empty.at({0.0, 0.0}).height));
	REQUIRE(empty.set(256, 1.0, {}, {}).ok());
	CHECK(std::isnan(empty.at({0.0, 0.0}).height));
	CHECK(empty.regions().empty());
}

TEST_CASE("region field: invalid regions are rejected, and the field stays unchanged") {
	const World world;
	RegionField field = world.field();
	const auto zero = [](glm::ivec2) {
		return 0u;
	};
	const FieldRegion good{{0, 0}, grid_of(zero), grid_of(zero)};
	FieldRegion small = good;
	small.heights = grid_of(zero, side / 2);
	FieldRegion mixed = good;
	mixed.controls = grid_of(zero, side / 2);
	FieldRegion distant = good;
	distant.location.x = RegionField::max_location;
	FieldRegion corner = good;
	corner.location = glm::ivec2(2000);
	CHECK_FALSE(field.set(1, 1.0, {}, {}).ok());
	for (const double spacing : {0.0, -1.0, 1e-4, 1e5, std::nan("")}) {
		CHECK_FALSE(field.set(side, spacing, {good}, {}).ok());
	}
	// `good` would be included twice, and `corner` is too far from it.
	for (const FieldRegion &bad : {small, mixed, distant, good, corner}) {
		CHECK_FALSE(field.set(side, 1.0, {good, bad}, {}).ok());
	}
	CHECK(field.at({3.0, 5.0}).height == world.height({3, 5}));
	std::array<Ground, 2> two;
	const glm::dvec2 origin{0.0};
	CHECK(field.sample({&origin, 1}, two).code == ErrorCode::wrong_size);
	CHECK(field.weigh({&origin, 1}, {}, two).code == ErrorCode::wrong_size);
}
