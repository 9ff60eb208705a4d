// Tests how the cubic tiles of layers on planets are requested and dropped around viewers.

#include "core/base/sight.hpp"
#include "core/base/tile_grid.hpp"
#include "core/streaming/tile_ball.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <random>
#include <set>
#include <string_view>
#include <tuple>
#include <vector>

using namespace thicket;

namespace {

using At = std::tuple<int, int, int>;

std::set<At> tiles_without(const TileBall &ball, const TileBall &other) {
	std::set<At> tiles;
	ball.visit_without(other, [&](glm::ivec3 at) { CHECK(tiles.emplace(at.x, at.y, at.z).second); });
	return tiles;
}

constexpr StreamLayer on_planet{.tile_size = 16.0, .view_distance = 70.0, .bottom = -400.0, .top = 400.0};

struct SpaceStage {
	TileStreamer streamer;
	StreamChanges changes;
	std::set<At> visible;

	explicit SpaceStage(const StreamLayer &layer) { REQUIRE(streamer.set_layers({&layer, 1}).ok()); }

	void settle(const Viewer &viewer) {
		for (int i = 0; i < 100 && (i == 0 || !streamer.idle()); ++i) {
			REQUIRE(streamer.update({&viewer, 1}, 100'000, changes).ok());
			for (const TileKey &key : changes.drop) {
				CHECK(visible.erase({key.tile.x, key.tile.y, key.slab}) == 1);
			}
			for (const TileRequest &request : changes.request) {
				CHECK(request.space.bottom == request.key.slab * 16.0);
				REQUIRE(streamer.ready(request));
			}
			while (const auto next = streamer.next_ready()) {
				REQUIRE(streamer.may_show(*next));
				REQUIRE(streamer.finish(*next));
				CHECK(visible.emplace(next->key.tile.x, next->key.tile.y, next->key.slab).second);
			}
		}
		CHECK(streamer.idle());
	}
};

} // namespace

TEST_CASE("tile ball: a ball contains the cubes that touch it, and lists those that a different ball lacks") {
	std::mt19937_64 random(3);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	const StreamLayer layer{.tile_size = 4.0, .view_distance = 40.0, .bottom = -21.0, .top = 30.0};
	for (int round = 0; round < 30; ++round) {
		const glm::dvec3 center = glm::dvec3(unit(random), unit(random), unit(random)) * 10.0;
		const double radius = 25.0 * std::abs(unit(random));
		TileBall ball;
		ball.set(layer, center, radius);
		TileBall other;
		other.set(layer, center + glm::dvec3(unit(random), unit(random), unit(random)) * 20.0, 15.0);
		const auto all = tiles_without(ball, TileBall());
		const auto remaining = tiles_without(ball, other);
		for (int z = -12; z <= 12; ++z) {
			for (int y = -12; y <= 12; ++y) {
				for (int x = -12; x <= 12; ++x) {
					const double distance = std::sqrt(distance_squared(tile_space(4.0, {x, y}, z), center));
					const bool in = all.contains({x, y, z});
					const bool high = -6 <= z && z <= 7; // The slabs from -21 to 30 m.
					CHECK((std::abs(distance - radius) < 1e-6 || in == (distance <= radius && high)));
					CHECK(ball.contains({x, y, z}) == in);
					CHECK(remaining.contains({x, y, z}) == (in && !other.contains({x, y, z})));
				}
			}
		}
	}
	TileBall plane;
	plane.set({.tile_size = 4.0, .view_distance = 40.0}, {0.0, 1e9, 0.0}, 10.0);
	CHECK(plane.contains({0, 0, all_slabs}));
	CHECK_FALSE(plane.contains({0, 0, 0}));
	plane.clear();
	CHECK_FALSE(plane.contains({0, 0, all_slabs}));
}

TEST_CASE("planet streaming: cubes are wanted by their distances in space") {
	SpaceStage stage(on_planet);
	for (const glm::dvec3 position : {glm::dvec3(0, 380, 0), glm::dvec3(0, 300, 0), glm::dvec3(380, 0, 3),
				 glm::dvec3(0, -390, 0), glm::dvec3(0, -390, 30)}) {
		stage.settle({{position.x, position.z}, 1.0, position.y});
		std::size_t near_count = 0;
		for (int slab = -25; slab < 25; ++slab) {
			for (int z = -10; z <= 10; ++z) {
				for (int x = -10; x <= 40; ++x) {
					const double distance = std::sqrt(distance_squared(tile_space(16.0, {x, z}, slab), position));
					const bool visible = stage.visible.contains({x, z, slab});
					CHECK((distance > 70.0 || visible));
					CHECK((distance < 1.1 * 70.0 + 16.0 + 4.0 || !visible));
					near_count += distance <= 70.0 ? 1 : 0;
				}
			}
		}
		CHECK(stage.visible.size() >= near_count);
		CHECK(stage.visible.size() < 3 * near_count);
	}
	stage.settle({{0.0, 0.0}, 1.0, 1000.0}); // This viewer is far from all tiles.
	CHECK(stage.visible.empty());
}

TEST_CASE("planet streaming: cubes without ground are not streamed, also after the ground has changed") {
	StreamLayer layer = on_planet;
	const Viewer viewer{{300.0, 0.0}, 1.0, 3.0};
	const auto check_shell = [&](SpaceStage &stage, double nearest, double farthest) {
		stage.settle(viewer);
		std::set<At> expected;
		for (int slab = -10; slab < 10; ++slab) {
			for (int z = -10; z <= 10; ++z) {
				for (int x = 0; x <= 40; ++x) {
					const TileSpace space = tile_space(16.0, {x, z}, slab);
					bool is_near = false;
					bool is_far = false;
					for (int corner = 0; corner < 8; ++corner) {
						const glm::dvec3 at((corner & 1) != 0 ? space.min.x : space.max.x,
								(corner & 2) != 0 ? space.bottom : space.top,
								(corner & 4) != 0 ? space.min.y : space.max.y);
						is_far = is_far || glm::length(at) >= nearest;
					}
					is_near = distance_squared(space, glm::dvec3(0.0)) <= farthest * farthest;
					if (is_near && is_far && distance_squared(space, glm::dvec3(300.0, 3.0, 0.0)) <= 70.0 * 70.0) {
						expected.emplace(x, z, slab);
					}
				}
			}
		}
		CHECK(expected.size() > 50);
		for (const At &at : expected) {
			CHECK(stage.visible.contains(at));
		}
		return expected.size();
	};
	SpaceStage all(layer);
	const std::size_t whole_count = check_shell(all, 0.0, 1e9);
	layer.nearest = 295.0;
	layer.farthest = 310.0;
	SpaceStage stage(layer);
	CHECK(2 * check_shell(stage, 295.0, 310.0) < whole_count);
	CHECK(2 * stage.visible.size() < all.visible.size());
	layer.farthest = 330.0;
	REQUIRE(stage.streamer.set_layers({&layer, 1}).ok());
	check_shell(stage, 295.0, 330.0);
	// Waiting cubes are discarded if the new settings leave them without ground.
	SpaceStage changing(on_planet);
	REQUIRE(changing.streamer.update({&viewer, 1}, 4, changing.changes).ok());
	const StreamChanges first = changing.changes;
	REQUIRE(changing.streamer.set_layers({&layer, 1}).ok());
	for (const TileRequest &request : first.request) {
		CHECK(changing.streamer.finish(request));
		changing.visible.emplace(request.key.tile.x, request.key.tile.y, request.key.slab);
	}
	check_shell(changing, 295.0, 330.0);
	layer.nearest = 1.0;
	layer.farthest = 0.0; // There is no ground.
	SpaceStage none(layer);
	none.settle(viewer);
	CHECK(none.visible.empty());
}

TEST_CASE("planet streaming: invalid settings are rejected, and a layer may get or lose a planet") {
	TileStreamer streamer;
	StreamLayer layer{.tile_size = 16.0, .view_distance = 300.0, .bottom = -400.0, .top = 400.0};
	const Status status = streamer.set_layers({&layer, 1});
	CHECK(status.code == ErrorCode::out_of_range);
	CHECK(std::string_view(status.property) == "view_distance");
	CHECK(describe(status).find("16 x tile_size") != std::string::npos);
	layer.view_distance = 100.0;
	REQUIRE(streamer.set_layers({&layer, 1}).ok());
	CHECK_FALSE(streamer.check({{0.0, 0.0}, 1.0, std::nan("")}).ok());
	CHECK_FALSE(streamer.check({{0.0, 0.0}, 1.0, 1e300}).ok());

	SpaceStage stage(on_planet);
	const Viewer viewer{{0.0, 0.0}, 1.0, 390.0};
	stage.settle(viewer);
	const std::size_t cubes = stage.visible.size();
	StreamLayer plane = on_planet;
	plane.bottom = StreamLayer().bottom;
	plane.top = StreamLayer().top;
	REQUIRE(stage.streamer.set_layers({&plane, 1}).ok());
	StreamChanges changes;
	REQUIRE(stage.streamer.update({&viewer, 1}, 100'000, changes).ok());
	CHECK(changes.drop.empty()); // The cubes stay until tiles that cover all heights replace them.
	for (const TileRequest &request : changes.request) {
		CHECK(request.space.covers_all_heights());
		CHECK(stage.streamer.finish(request));
	}
	REQUIRE(stage.streamer.update({&viewer, 1}, 100'000, changes).ok());
	CHECK(changes.drop.size() == cubes);
}

TEST_CASE("planet streaming: distances to instances are those in space") {
	const Sight plane{100.0, 0.1};
	const Sight space{100.0, 0.1, true};
	CHECK(sight_distance(10.0, 500.0, plane.height_limit(1.0)) == 90.0);
	CHECK(sight_distance(10.0, 500.0, space.height_limit(1.0)) == 500.0);
}
