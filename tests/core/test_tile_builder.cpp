#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "core/terrain/heightfield.hpp"
#include "allocation_count.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <thread>
#include <vector>

using namespace thicket;

namespace {

/// Waves of hills over 600 x 400 m, from sharp to gentle, at the corner of the world that `offset` gives.
Heightfield hills(glm::dvec2 offset = glm::dvec2(0.0)) {
	const HeightfieldFrame frame{
			{61, 41}, {offset + glm::dvec2(-300.0, -200.0), offset + glm::dvec2(300.0, 200.0)}, 0.0, 90.0};
	std::vector<std::uint16_t> posts;
	for (int row = 0; row < 41; ++row) {
		for (int column = 0; column < 61; ++column) {
			posts.push_back(static_cast<std::uint16_t>((column * column * 7919 + row * row * 104729) % 65536));
		}
	}
	Heightfield field;
	REQUIRE(field.set(frame, posts).ok());
	return field;
}

/// Ground that a function makes, for tests of the builder's dealings with it.
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

/// Raises a flag when the ground is asked for: a cancellation that comes in mid-build.
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

LayerSettings rich_layer() {
	LayerSettings layer;
	layer.set = {.seed = 99, .radius = 1.5, .levels = 2, .layer = 3};
	layer.rules.max_slope_degrees = 50.0;
	layer.rules.slope_falloff = 15.0;
	layer.rules.min_height = 10.0;
	layer.rules.height_falloff = 20.0;
	layer.placement.align_to_normal = 0.7;
	layer.placement.min_scale = 0.5;
	layer.placement.height_offset = -0.125;
	layer.mesh_weights = {1.0f, 2.0f, 0.5f};
	return layer;
}

constexpr Rect tile_of_hills{{-64.0, 0.0}, {64.0, 128.0}};

TileInstances built(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, rect, tile).ok());
	return tile;
}

std::size_t size_of(const TileInstances &tile) {
	std::size_t size = 0;
	for (const MeshInstances &mesh : tile.meshes) {
		size += mesh.size();
	}
	return size;
}

glm::dvec3 world_position(const TileInstances &tile, const MeshInstances &mesh, std::size_t i) {
	const float *transform = mesh.buffer.data() + i * floats_per_instance;
	return tile.origin + glm::dvec3(transform[3], transform[7], transform[11]);
}

using Transforms = std::map<std::uint64_t, std::vector<float>>;

/// The transforms of all meshes by id.
Transforms transforms_of(const TileInstances &tile) {
	Transforms result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const float *transform = mesh.buffer.data() + i * floats_per_instance;
			result[mesh.ids[i]] = std::vector<float>(transform, transform + floats_per_instance);
		}
	}
	return result;
}

} // namespace

TEST_CASE("tile: with open rules every point of the set stands on its place, on the ground") {
	const Heightfield terrain = hills();
	LayerSettings layer;
	layer.set = {.seed = 5, .radius = 2.0, .levels = 1, .layer = 0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	for (const Rect &rect : {tile_of_hills, Rect{{-17.25, -93.5}, {41.0, -80.0}}, Rect{{0.0, 0.0}, {3.0, 2.0}}}) {
		REQUIRE(sampler.sample(layer.set, rect, points).ok());
		std::map<std::uint64_t, SamplePoint> by_id;
		for (const SamplePoint &point : points) {
			by_id.emplace(point.id, point);
		}
		const TileInstances tile = built(layer, terrain, rect);
		REQUIRE(tile.meshes.size() == 1);
		const MeshInstances &mesh = tile.meshes[0];
		CHECK(mesh.size() == points.size());
		CHECK(tile.counts.sampled == points.size());
		CHECK(tile.counts.dense == points.size());
		CHECK(tile.counts.placed == points.size());
		CHECK(mesh.buffer.size() == mesh.size() * floats_per_instance);
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			REQUIRE(by_id.contains(mesh.ids[i]));
			const SamplePoint &point = by_id[mesh.ids[i]];
			const glm::dvec3 position = world_position(tile, mesh, i);
			CHECK(mesh.ranks[i] == point.rank);
			CHECK(glm::distance(glm::dvec2(position.x, position.z), point.position) < 1e-5);
			CHECK(std::abs(position.y - terrain.at(point.position).height) < 1e-4);
		}
	}
}

TEST_CASE("tile: instances are sorted by rank and id, and the box holds them") {
	const TileInstances tile = built(rich_layer(), hills(), tile_of_hills);
	CHECK(tile.meshes.size() == 3);
	CHECK(tile.counts.placed == size_of(tile));
	CHECK(tile.counts.placed > 500);
	CHECK(tile.counts.placed < tile.counts.dense);
	for (const MeshInstances &mesh : tile.meshes) {
		REQUIRE(mesh.size() > 10);
		glm::dvec3 lowest(1e9);
		glm::dvec3 highest(-1e9);
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const glm::dvec3 local = world_position(tile, mesh, i) - tile.origin;
			lowest = glm::min(lowest, local);
			highest = glm::max(highest, local);
			if (i > 0) {
				CHECK(std::pair(mesh.ranks[i - 1], mesh.ids[i - 1]) < std::pair(mesh.ranks[i], mesh.ids[i]));
			}
		}
		CHECK(glm::distance(lowest, glm::dvec3(mesh.min)) < 1e-4);
		CHECK(glm::distance(highest, glm::dvec3(mesh.max)) < 1e-4);
		CHECK(mesh.max_scale <= 1.0f);
		CHECK(mesh.max_scale > 0.95f);
	}
	// Near its ground, in whole metres.
	CHECK(tile.origin.y == std::floor(tile.origin.y));
	CHECK(tile.origin.y > 0.0);
	CHECK(tile.origin.y < 90.0);
}

TEST_CASE("tile: rules are pure filters, no instance that stays changes a bit") {
	const Heightfield terrain = hills();
	LayerSettings open = rich_layer();
	open.rules = {};
	const Transforms all = transforms_of(built(open, terrain, tile_of_hills));
	std::vector<Rules> tries(6, Rules{});
	tries[0].max_slope_degrees = 30.0;
	tries[1].min_slope_degrees = 30.0;
	tries[1].slope_falloff = 20.0;
	tries[2].density = 0.3;
	tries[3].min_height = 40.0;
	tries[4].max_height = 40.0;
	tries[4].height_falloff = 10.0;
	tries[5] = rich_layer().rules;
	for (const Rules &rules : tries) {
		LayerSettings filtered = open;
		filtered.rules = rules;
		const Transforms some = transforms_of(built(filtered, terrain, tile_of_hills));
		CHECK(some.size() > 50);
		CHECK(some.size() < all.size());
		for (const auto &[id, transform] : some) {
			const auto found = all.find(id);
			REQUIRE(found != all.end());
			CHECK(std::memcmp(found->second.data(), transform.data(), sizeof(float) * floats_per_instance) == 0);
		}
	}
}

TEST_CASE("tile: what stands obeys its rules") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	layer.placement.height_offset = 0.0;
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, tile_of_hills, points).ok());
	const Transforms stands = transforms_of(tile);
	for (const SamplePoint &point : points) {
		if (stands.contains(point.id)) {
			const Ground ground = terrain.at(point.position);
			CHECK(ground.height >= 10.0f);
			CHECK(std::acos(double{ground.normal.y}) * 57.29577951308232 <= 50.0 + 1e-4);
		}
	}
}

TEST_CASE("tile: new meshes or another scale leave everything where it stands") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	const Transforms before = transforms_of(built(layer, terrain, tile_of_hills));
	layer.mesh_weights = {1.0f};
	CHECK(transforms_of(built(layer, terrain, tile_of_hills)) == before);
	layer.placement.max_scale = 4.0;
	for (const auto &[id, transform] : transforms_of(built(layer, terrain, tile_of_hills))) {
		REQUIRE(before.contains(id));
		for (const std::size_t at : {3u, 7u, 11u}) {
			CHECK(transform[at] == before.at(id)[at]);
		}
	}
}

TEST_CASE("tile: the same tile twice, in pieces, after other work or on another thread is the same to the bit") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	const TileInstances first = built(layer, terrain, tile_of_hills);

	TileBuilder used;
	TileInstances tile;
	LayerSettings other;
	other.set.radius = 0.7;
	REQUIRE(used.build(other, FlatTerrain(7.0f), {{5.0, 5.0}, {60.0, 20.0}}, tile).ok());
	REQUIRE(used.build(layer, terrain, tile_of_hills, tile).ok());
	CHECK(digest(tile) == digest(first));

	REQUIRE(used.find_points(layer, tile_of_hills).ok());
	std::vector<Ground> ground(used.positions().size());
	REQUIRE(terrain.sample(used.positions(), ground).ok());
	for (int repeat = 0; repeat < 2; ++repeat) {
		REQUIRE(used.place(ground, tile).ok());
		CHECK(digest(tile) == digest(first));
	}

	std::array<std::uint64_t, 2> digests{};
	std::vector<std::thread> threads;
	for (std::uint64_t &each : digests) {
		threads.emplace_back([&each, &terrain, &layer] {
			TileBuilder builder;
			TileInstances mine;
			if (builder.build(layer, terrain, tile_of_hills, mine).ok()) {
				each = digest(mine);
			}
		});
	}
	for (std::thread &thread : threads) {
		thread.join();
	}
	CHECK(digests[0] == digest(first));
	CHECK(digests[1] == digest(first));

	LayerSettings reseeded = layer;
	++reseeded.set.seed;
	CHECK(digest(built(reseeded, terrain, tile_of_hills)) != digest(first));
}

TEST_CASE("tile: halves hold what the whole holds") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	const TileInstances whole = built(layer, terrain, tile_of_hills);
	std::map<std::uint64_t, glm::dvec3> positions;
	for (const double split : {-10.0, 0.0, 33.3}) {
		std::size_t count = 0;
		for (const Rect &half : {Rect{tile_of_hills.min, {split, 128.0}}, Rect{{split, 0.0}, tile_of_hills.max}}) {
			const TileInstances part = built(layer, terrain, half);
			count += size_of(part);
			for (const MeshInstances &mesh : part.meshes) {
				for (std::size_t i = 0; i < mesh.size(); ++i) {
					positions[mesh.ids[i]] = world_position(part, mesh, i);
				}
			}
		}
		CHECK(count == size_of(whole));
		for (std::size_t mesh = 0; mesh < whole.meshes.size(); ++mesh) {
			for (std::size_t i = 0; i < whole.meshes[mesh].size(); ++i) {
				const auto found = positions.find(whole.meshes[mesh].ids[i]);
				REQUIRE(found != positions.end());
				CHECK(glm::distance(found->second, world_position(whole, whole.meshes[mesh], i)) < 2e-5);
			}
		}
	}
}

TEST_CASE("tile: 10,000 km out a tile is as exact as at the origin") {
	const glm::dvec2 corner(9.99e6 + 0.37, -9.99e6 + 0.81);
	LayerSettings layer;
	layer.set = {.seed = 8, .radius = 2.0, .levels = 1, .layer = 0};
	const Rect rect{corner, corner + 64.0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, rect, points).ok());
	const TileInstances tile = built(layer, FlatTerrain(1234.5f), rect);
	const MeshInstances &mesh = tile.meshes[0];
	REQUIRE(mesh.size() == points.size());
	REQUIRE(mesh.size() > 500);
	std::map<std::uint64_t, glm::dvec2> expected;
	for (const SamplePoint &point : points) {
		expected[point.id] = point.position;
	}
	std::vector<glm::vec2> local;
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		const glm::dvec3 position = world_position(tile, mesh, i);
		CHECK(glm::distance(glm::dvec2(position.x, position.z), expected[mesh.ids[i]]) < 3e-6);
		CHECK(position.y == 1234.5);
		local.emplace_back(mesh.buffer[i * floats_per_instance + 3], mesh.buffer[i * floats_per_instance + 11]);
	}
	for (std::size_t i = 0; i < local.size(); ++i) {
		for (std::size_t j = 0; j < i; ++j) {
			REQUIRE(glm::distance(local[i], local[j]) > 2.0f - 1e-5f);
		}
	}
}

TEST_CASE("tile: nothing stands where there is no ground, and its neighbours do not care") {
	const FunctionTerrain whole([](glm::dvec2) { return Ground{4.0f, {0.0f, 1.0f, 0.0f}}; });
	// Every way of being no ground, by quarter.
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
	const TileInstances with = built(layer, pierced, rect);
	const Transforms all = transforms_of(built(layer, whole, rect));
	std::size_t expected = 0;
	for (const auto &[id, transform] : all) {
		const glm::dvec2 position(32.0 + transform[3], 32.0 + transform[11]);
		expected += !std::isnan(pierced.at(position).height) && position.x >= 10.0 && position.y >= 10.0 &&
						position.x <= 60.0
				? 1
				: 0;
	}
	CHECK(size_of(with) == expected);
	for (const auto &[id, transform] : transforms_of(with)) {
		REQUIRE(all.contains(id));
		CHECK(transform == all.at(id));
	}
	// The middle is a hole: the origin's height comes from around it.
	CHECK(with.origin.y == 4.0);

	const TileInstances nowhere = built(layer, FlatTerrain(std::nanf("")), rect);
	CHECK(size_of(nowhere) == 0);
	CHECK(nowhere.meshes.size() == 1);
	CHECK(nowhere.origin == glm::dvec3(32.0, 0.0, 32.0));
	CHECK(nowhere.meshes[0].min == glm::vec3(0.0f));
	CHECK(nowhere.meshes[0].max == glm::vec3(0.0f));
}

TEST_CASE("tile: tiny and empty rectangles are fine") {
	LayerSettings layer;
	layer.set.radius = 100.0;
	CHECK(size_of(built(layer, FlatTerrain(), {{1.0, 1.0}, {1.0, 1.0}})) == 0);
	CHECK(size_of(built(layer, FlatTerrain(), {{1.0, 1.0}, {1.0 + 1e-9, 500.0}})) <= 1);
}

TEST_CASE("tile: nothing is allocated once warm") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	TileBuilder builder;
	TileInstances tile;
	for (int repeat = 0; repeat < 2; ++repeat) {
		REQUIRE(builder.build(layer, terrain, tile_of_hills, tile).ok());
	}
	const std::size_t before = allocation_count();
	const Status status = builder.build(layer, terrain, tile_of_hills, tile);
	const std::size_t after = allocation_count();
	CHECK(status.ok());
	CHECK(after == before);
}

TEST_CASE("tile: cancelling ends the build with a valid tile") {
	TileBuilder builder;
	TileInstances tile;
	std::atomic<bool> cancel = true;
	CHECK(builder.build(rich_layer(), hills(), tile_of_hills, tile, &cancel).code == ErrorCode::cancelled);

	cancel = false;
	CHECK(builder.build(rich_layer(), CancellingTerrain(cancel), tile_of_hills, tile, &cancel).code ==
			ErrorCode::cancelled);
	for (const MeshInstances &mesh : tile.meshes) {
		CHECK(mesh.buffer.size() == mesh.size() * floats_per_instance);
		CHECK(mesh.ranks.size() == mesh.size());
	}
	// And the builder is as good as new.
	REQUIRE(builder.build(rich_layer(), hills(), tile_of_hills, tile).ok());
	CHECK(digest(tile) == digest(built(rich_layer(), hills(), tile_of_hills)));
}

TEST_CASE("tile: bad input is refused by name and value, and the tile stays as it was") {
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

	TileBuilder fresh;
	check_refused(fresh.place({}, tile), ErrorCode::missing, "points", 0.0);
	REQUIRE(fresh.find_points(rich_layer(), tile_of_hills).ok());
	const std::vector<Ground> wrong(3);
	check_refused(fresh.place(wrong, tile), ErrorCode::wrong_size, "ground", 3.0);
	CHECK(digest(tile) == before);
}
