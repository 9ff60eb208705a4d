#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "refusal.hpp"
#include "repeated_builds.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A terrain whose ground is computed by a function.
class FunctionTerrain final : public Terrain {
public:
	explicit FunctionTerrain(std::function<Ground(glm::dvec2)> function) : function_(std::move(function)) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		std::ranges::transform(positions, r_ground.begin(), function_);
		return {};
	}

private:
	std::function<Ground(glm::dvec2)> function_;
};

class FailingTerrain final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2>, std::span<Ground>) const override {
		return {ErrorCode::missing, "heights", 0.0};
	}
};

/// A terrain that sets a flag when its ground is sampled, which cancels the build midway.
class CancellingTerrain final : public Terrain {
public:
	explicit CancellingTerrain(std::atomic<bool> &flag) : flag_(flag) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		flag_ = true;
		return FlatTerrain().sample(positions, r_ground);
	}

private:
	std::atomic<bool> &flag_;
};

} // namespace

TEST_CASE("tile: there are no instances without ground, and their neighbors are unaffected") {
	const FunctionTerrain whole([](glm::dvec2) { return Ground{4.0f, {0.0f, 1.0f, 0.0f}}; });
	// The center and three edges lack ground, each in a different way.
	const FunctionTerrain pierced([](glm::dvec2 position) {
		Ground ground{4.0f, {0.0f, 1.0f, 0.0f}};
		if (glm::length(position - glm::dvec2(32.0)) < 8.0) {
			ground.height = std::nanf("");
		} else if (position.x < 10.0) {
			ground.normal.x = std::nanf("");
		} else if (position.y < 10.0) {
			ground.normal.y = -1.0f;
		} else if (position.x > 60.0) {
			ground.height = std::numeric_limits<float>::infinity();
		}
		return ground;
	});
	LayerSettings layer;
	const Rect rect{{0.0, 0.0}, {64.0, 64.0}};
	const TileInstances pierced_tile = built(layer, pierced, rect);
	const Transforms all = transforms_of(built(layer, whole, rect));
	std::size_t expected = 0;
	for (const auto &[id, transform] : all) {
		const glm::dvec2 position(32.0 + transform[3], 32.0 + transform[11]);
		expected += !std::isnan(pierced.at(position).height) && position.x >= 10.0 && position.y >= 10.0 &&
						position.x <= 60.0
				? 1
				: 0;
	}
	CHECK(size_of(pierced_tile) == expected);
	for (const auto &[id, transform] : transforms_of(pierced_tile)) {
		REQUIRE(all.contains(id));
		CHECK(transform == all.at(id));
	}
	// The center is a hole, so the height of the origin comes from the ground around it.
	CHECK(pierced_tile.origin.y == 4.0);

	const TileInstances empty_tile = built(layer, FlatTerrain(std::nanf("")), rect);
	CHECK(size_of(empty_tile) == 0);
	CHECK(empty_tile.meshes.size() == 1);
	CHECK(empty_tile.origin == glm::dvec3(32.0, 0.0, 32.0));
	CHECK(empty_tile.meshes[0].min == glm::vec3(0.0f));
	CHECK(empty_tile.meshes[0].max == glm::vec3(0.0f));
}

TEST_CASE("tile: tiny and empty rectangles are valid") {
	LayerSettings layer;
	layer.set.radius = 100.0;
	CHECK(size_of(built(layer, FlatTerrain(), {{1.0, 1.0}, {1.0, 1.0}})) == 0);
	CHECK(size_of(built(layer, FlatTerrain(), {{1.0, 1.0}, {1.0 + 1e-9, 500.0}})) <= 1);
}

TEST_CASE("tile: repeated builds allocate nothing") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	check_repeated_builds_allocate_nothing(layer, terrain);
}

TEST_CASE("tile: canceling ends the build with a valid tile") {
	TileBuilder builder;
	TileInstances tile;
	std::atomic<bool> cancel = true;
	CHECK(builder.build(rich_layer(), hills(), tile_of_hills, tile, &cancel).code == ErrorCode::cancelled);

	cancel = false;
	CHECK(builder.build(rich_layer(), CancellingTerrain(cancel), tile_of_hills, tile, &cancel).code ==
			ErrorCode::cancelled);
	for (const MeshInstances &mesh : tile.meshes) {
		CHECK(mesh.buffer.size() == mesh.size() * transform_floats);
		CHECK(mesh.ranks.size() == mesh.size());
	}
	// The builder remains usable.
	REQUIRE(builder.build(rich_layer(), hills(), tile_of_hills, tile).ok());
	CHECK(digest(tile) == digest(built(rich_layer(), hills(), tile_of_hills)));
}

TEST_CASE("tile: the error for invalid input names the property and the value, and the tile stays unchanged") {
	const Heightfield terrain = hills();
	TileBuilder builder;
	TileInstances tile = built(rich_layer(), terrain, tile_of_hills);
	const std::uint64_t before = digest(tile);
	const auto refuse = [&](auto change, ErrorCode code, const char *property, double value) {
		LayerSettings bad = rich_layer();
		change(bad);
		check_refused(builder.build(bad, terrain, tile_of_hills, tile), code, property, value);
		CHECK(digest(tile) == before);
	};
	refuse([](auto &bad) { bad.set.radius = 0.0; }, ErrorCode::not_positive, "radius", 0.0);
	refuse([](auto &bad) { bad.set.radius = -1.0; }, ErrorCode::not_positive, "radius", -1.0);
	refuse([](auto &bad) { bad.set.radius = nan_value; }, ErrorCode::not_finite, "radius", nan_value);
	refuse([](auto &bad) { bad.set.radius = infinite_value; }, ErrorCode::not_finite, "radius", infinite_value);
	refuse([](auto &bad) { bad.rules.density = 2.0; }, ErrorCode::out_of_range, "density", 2.0);
	refuse([](auto &bad) { bad.placement.min_scale = -2.0; }, ErrorCode::not_positive, "min_scale", -2.0);
	refuse([](auto &bad) { bad.mesh_weights = {0.0f}; }, ErrorCode::not_positive, "mesh_weights", 0.0);

	LayerSettings fine = rich_layer();
	for (const Rect &rect : {Rect{{10.0, 0.0}, {0.0, 10.0}}, Rect{{0.0, 0.0}, {nan_value, 10.0}},
				 Rect{{0.0, 0.0}, {infinite_value, 10.0}}, Rect{{1e12, 0.0}, {1e12 + 10.0, 10.0}}}) {
		CHECK_FALSE(builder.build(fine, terrain, rect, tile).ok());
		CHECK(digest(tile) == before);
	}
	fine.set.radius = min_radius;
	CHECK(builder.build(fine, terrain, tile_of_hills, tile).code == ErrorCode::too_many_points);
	CHECK(digest(tile) == before);

	check_refused(
			builder.build(rich_layer(), FailingTerrain(), tile_of_hills, tile), ErrorCode::missing, "heights", 0.0);
	CHECK(digest(tile) == before);

	TileBuilder fresh_builder;
	check_refused(fresh_builder.place({}, tile), ErrorCode::missing, "points", 0.0);
	REQUIRE(fresh_builder.find_points(rich_layer(), tile_of_hills).ok());
	const std::vector<Ground> wrong_ground(3);
	check_refused(fresh_builder.place(wrong_ground, tile), ErrorCode::wrong_size, "ground", 3.0);
	CHECK(digest(tile) == before);
}
