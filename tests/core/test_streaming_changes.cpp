#include "allocation_count.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "refusal.hpp"
#include "streaming_stage.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("streaming: an outdated tile stays visible until its successor is ready") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const auto visible = stage.visible;
	const std::size_t requested = stage.requested;
	const std::size_t of_layer_1 = tiles_of(stage, 1).size();
	stage.streamer.invalidate(1);
	CHECK_FALSE(stage.streamer.idle());
	stage.update(viewers);
	CHECK(stage.changes.drop.empty());
	CHECK(stage.changes.request.size() == of_layer_1);
	CHECK(std::ranges::all_of(
			stage.changes.request, [](const TileRequest &request) { return request.key.layer == 1; }));

	// A tile is outdated again before its request is finished. The first result is shown, and then
	// the tile is requested once more.
	const TileRequest early_request = stage.changes.request[0];
	stage.streamer.invalidate(1);
	stage.update(viewers);
	CHECK(stage.changes.empty());
	stage.finish(early_request);
	stage.update(viewers);
	CHECK(stage.changes.cancel.empty());
	REQUIRE(stage.changes.request.size() == 1);
	CHECK(stage.changes.request[0].key == early_request.key);
	CHECK(stage.changes.request[0].ticket != early_request.ticket);
	CHECK_FALSE(stage.streamer.finish(early_request));
	stage.settle(viewers);
	CHECK(stage.requested == requested + 2 * of_layer_1);
	CHECK(stage.dropped == 0);
	CHECK(stage.visible.size() == visible.size());

	stage.streamer.invalidate(7);
	stage.update(viewers);
	CHECK(stage.changes.empty());
}

TEST_CASE("streaming: requests that are no longer needed are canceled and repeated later") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.update(viewers);
	const std::vector<TileRequest> early_requests = stage.changes.request;
	stage.streamer.invalidate(0);
	stage.streamer.cancel(0);
	stage.streamer.cancel(9);
	stage.update(viewers);
	const auto of_layer_0 = static_cast<std::size_t>(
			std::ranges::count_if(early_requests, [](const TileRequest &request) { return request.key.layer == 0; }));
	CHECK(of_layer_0 > 0);
	CHECK(stage.changes.cancel.size() == of_layer_0);
	CHECK(stage.changes.request.size() == of_layer_0);
	stage.finish_all();
	stage.update(viewers);
	CHECK(stage.streamer.idle());
}

TEST_CASE("streaming: with changes in every update, the nearest tiles are still updated") {
	Stage stage({{10.0, 100.0}});
	const std::vector<Viewer> viewers{{{5.0, 5.0}}};
	stage.settle(viewers);
	constexpr std::size_t max_count = 12;
	std::map<std::pair<int, int>, int> renewed;
	for (int change = 0; change < 60; ++change) {
		stage.streamer.invalidate(0);
		stage.update(viewers, max_count);
		CHECK(stage.pending.size() <= max_count);
		CHECK(stage.changes.cancel.empty());
		// Some requests are finished before the next change, in the order in which they were made.
		for (int answered_count = 0; answered_count < 5 && !stage.pending.empty(); ++answered_count) {
			const auto first = std::ranges::min_element(
					stage.pending, {}, [](const auto &pending) { return pending.second.ticket; });
			const TileRequest request = first->second;
			++renewed[{request.key.tile.x, request.key.tile.y}];
			stage.finish(request);
		}
	}
	for (int x = -1; x <= 1; ++x) {
		for (int y = -1; y <= 1; ++y) {
			CHECK(renewed[{x, y}] > 10);
		}
	}
	// The last change applies as soon as pending work is finished.
	stage.update(viewers, max_count);
	stage.finish_all();
	stage.settle(viewers);
	CHECK(stage.dropped == 0);
}

TEST_CASE("streaming: an edit outdates only the tiles that it touches") {
	Stage stage({{10.0, 100.0}});
	const std::vector<Viewer> viewers{{{5.0, 5.0}}};
	stage.settle(viewers);
	stage.streamer.invalidate(0, {{12.0, -3.0}, {20.0, 4.0}});
	stage.update(viewers);
	REQUIRE(stage.changes.request.size() == 2);
	CHECK(stage.changes.request[0].key.tile == glm::ivec2(1, 0));
	CHECK(stage.changes.request[1].key.tile == glm::ivec2(1, -1));
	stage.finish_all();
	stage.streamer.invalidate(0, {{1e6, 1e6}, {2e6, 2e6}});
	stage.update(viewers);
	CHECK(stage.changes.empty());
}

TEST_CASE("streaming: tiles that are only kept can be dropped at once") {
	Stage stage({{10.0, 100.0}});
	const std::vector<Viewer> start{{{5.0, 5.0}}};
	stage.streamer.drop_unseen({{0.0, 0.0}, {10.0, 10.0}});
	stage.settle(start);
	const std::vector<Viewer> viewers{{{17.0, 5.0}}};
	stage.settle(viewers);
	CHECK(stage.dropped == 0);
	// The tile from x = -90 to -80 is 97 m away and in view. The tile before it is only kept.
	stage.streamer.drop_unseen({{-95.0, 0.0}, {-85.0, 10.0}});
	stage.update(viewers);
	REQUIRE(stage.changes.drop.size() == 1);
	CHECK(stage.changes.drop[0].tile == glm::ivec2(-10, 0));
	CHECK(stage.changes.request.empty());
	CHECK(stage.streamer.idle());
	stage.streamer.drop_unseen({{-95.0, 0.0}, {-85.0, 10.0}});
	stage.update(viewers);
	CHECK(stage.changes.empty());
	stage.settle(start);
	CHECK(stage.visible.contains({0, stage.visible.begin()->second.grid, -10, 0}));
}

TEST_CASE("streaming: a new view distance keeps the loaded tiles") {
	std::vector<StreamLayer> layers = two_layers;
	Stage stage(layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const auto before = stage.visible;
	layers[0].view_distance = 180.0;
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.settle(viewers);
	CHECK(stage.dropped == 0);
	CHECK(std::ranges::includes(
			stage.visible, before, {}, &std::pair<const Name, TileKey>::first, &std::pair<const Name, TileKey>::first));
	check_view(stage, layers, viewers);
	// Setting the same layers again has no effect.
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.update(viewers);
	CHECK(stage.changes.empty());
}

TEST_CASE("streaming: after a change to the tile size, the old tiles stay until new tiles cover them") {
	std::vector<StreamLayer> layers = two_layers;
	Stage stage(layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const std::uint32_t old_grid = stage.visible.rbegin()->second.grid;
	const std::size_t old_tiles = tiles_of(stage, 1).size();
	const std::size_t other_tiles = tiles_of(stage, 0).size();
	layers[1].tile_size = 70.0;
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.update(viewers);
	CHECK(stage.changes.cancel.empty());
	CHECK(stage.changes.drop.empty());
	CHECK(stage.visible.size() == old_tiles + other_tiles);
	CHECK(std::ranges::all_of(
			stage.changes.request, [](const TileRequest &request) { return request.key.layer == 1; }));

	// While the requests are finished one by one, every position must remain covered by a visible
	// tile.
	while (!stage.pending.empty()) {
		stage.finish(TileRequest(stage.pending.begin()->second));
		stage.update(viewers);
		for (double x = -200.0; x <= 200.0; x += 20.0) {
			for (double y = -90.0; y <= 90.0; y += 20.0) {
				CHECK(std::ranges::any_of(stage.visible, [&](const auto &entry) {
					const TileKey &key = entry.second;
					const double size = key.grid == old_grid ? 50.0 : 70.0;
					return key.layer == 1 && tile_rect(size, key.tile).contains({x, y});
				}));
			}
		}
	}
	stage.settle(viewers);
	CHECK(stage.dropped == old_tiles);
	CHECK(tiles_of(stage, 0).size() == other_tiles);
	check_view(stage, layers, viewers);
}

TEST_CASE("streaming: a large old tile is dropped once the new tiles in view are loaded") {
	Stage stage({{1000.0, 10.0}});
	const std::vector<Viewer> viewers{{{500.0, 500.0}}};
	stage.settle(viewers);
	REQUIRE(stage.visible.size() == 1);
	const Name old = stage.visible.begin()->first;
	REQUIRE(stage.streamer.set_layers(std::vector<StreamLayer>{{2.0, 10.0}}).ok());
	stage.update(viewers);
	CHECK(stage.pending.size() > 20);
	while (!stage.pending.empty()) {
		stage.finish(TileRequest(stage.pending.begin()->second));
		stage.update(viewers);
		CHECK(stage.visible.contains(old) == !stage.pending.empty());
	}
	CHECK(stage.streamer.idle());
	check_view(stage, {{2.0, 10.0}}, viewers);
}

TEST_CASE("streaming: a removed layer drops its tiles, and an added one requests its own") {
	std::vector<StreamLayer> layers = two_layers;
	Stage stage(layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	REQUIRE(stage.streamer.set_layers(std::vector<StreamLayer>{layers[0]}).ok());
	stage.settle(viewers);
	CHECK(tiles_of(stage, 1).empty());
	check_view(stage, {layers[0]}, viewers);

	layers.push_back({25.0, 60.0});
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.update(viewers, 10);
	// All layers are removed while tiles are being built.
	REQUIRE(stage.streamer.set_layers(std::vector<StreamLayer>{}).ok());
	stage.settle(viewers);
	CHECK(stage.visible.empty());
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.settle(viewers);
	check_view(stage, layers, viewers);
}

TEST_CASE("streaming: clear drops all tiles and keeps the layers") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	stage.update({{{150.0, 0.0}}}, 3);
	const TileRequest late_request = stage.changes.request.at(0);
	stage.streamer.clear();
	stage.pending.clear();
	stage.visible.clear();
	CHECK_FALSE(stage.streamer.finish(late_request));
	stage.settle(viewers);
	check_view(stage, two_layers, viewers);
}

TEST_CASE("streaming: an old tile is dropped if its replacement is canceled out of view") {
	Stage stage({{32.0, 100.0}});
	std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	REQUIRE(stage.streamer.set_layers(std::vector<StreamLayer>{{40.0, 100.0}}).ok());
	stage.update(viewers);
	// The viewer moves, so that some requested tiles are out of sight. All requested tiles in sight
	// are finished.
	viewers[0].position.x += 30.0;
	stage.update(viewers);
	const auto in_sight = [&](const auto &each) {
		return distance_squared(each.second.space, viewers[0].position) <= 100.0 * 100.0;
	};
	for (auto next = std::ranges::find_if(stage.pending, in_sight); next != stage.pending.end();
			next = std::ranges::find_if(stage.pending, in_sight)) {
		stage.finish(TileRequest(next->second));
	}
	stage.update(viewers);
	REQUIRE_FALSE(stage.pending.empty());
	REQUIRE_FALSE(stage.streamer.idle());
	stage.streamer.cancel(0);
	stage.update(viewers);
	CHECK(stage.streamer.idle());
	check_view(stage, {{40.0, 100.0}}, viewers);
}

TEST_CASE("streaming: the error for invalid input names the property and the value, and the last valid state stays") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const auto refuse_layer = [&](StreamLayer bad, ErrorCode code, const char *property, double value) {
		check_refused(stage.streamer.set_layers(std::vector<StreamLayer>{two_layers[0], bad}), code, property, value);
		stage.update(viewers);
		CHECK(stage.changes.empty());
		check_view(stage, two_layers, viewers);
	};
	refuse_layer({0.0, 100.0}, ErrorCode::not_positive, "tile_size", 0.0);
	refuse_layer({-8.0, 100.0}, ErrorCode::not_positive, "tile_size", -8.0);
	refuse_layer({nan_value, 100.0}, ErrorCode::not_finite, "tile_size", nan_value);
	refuse_layer({infinite_value, 100.0}, ErrorCode::not_finite, "tile_size", infinite_value);
	refuse_layer({10.0, -1.0}, ErrorCode::out_of_range, "view_distance", -1.0);
	refuse_layer({10.0, nan_value}, ErrorCode::not_finite, "view_distance", nan_value);
	refuse_layer({10.0, 641.0}, ErrorCode::out_of_range, "view_distance", 641.0);
	refuse_layer({1e-300, 1.0}, ErrorCode::out_of_range, "tile_size", 1e-300);
	refuse_layer({1e300, 1.0}, ErrorCode::out_of_range, "tile_size", 1e300);

	const auto refuse_viewer = [&](Viewer bad, ErrorCode code, const char *property, double value) {
		StreamChanges changes;
		check_refused(
				stage.streamer.update(std::vector<Viewer>{viewers[0], bad}, unlimited, changes), code, property, value);
		CHECK(changes.empty());
		stage.update(viewers);
		CHECK(stage.changes.empty());
	};
	refuse_viewer({{nan_value, 0.0}}, ErrorCode::not_finite, "viewer.x", nan_value);
	refuse_viewer({{0.0, infinite_value}}, ErrorCode::not_finite, "viewer.y", infinite_value);
	refuse_viewer({{1e300, 0.0}}, ErrorCode::out_of_range, "viewer.x", 1e300);
	refuse_viewer({{0.0, 0.0}, nan_value}, ErrorCode::not_finite, "viewer.radius_scale", nan_value);
	refuse_viewer({{0.0, 0.0}, -1.0}, ErrorCode::out_of_range, "viewer.radius_scale", -1.0);
	CHECK(stage.streamer.check(viewers[0]).ok());
	CHECK(stage.streamer.check({{1e300, 0.0}}).code == ErrorCode::out_of_range);

	TileRequest made_up;
	made_up.key.layer = 12;
	CHECK_FALSE(stage.streamer.finish(made_up));
	CHECK_FALSE(stage.streamer.finish({}));
}

TEST_CASE("streaming: a layer that is edited in every frame, for example by a slider, does not fill the queue") {
	TileStreamer streamer;
	REQUIRE(streamer.set_layers(std::vector<StreamLayer>{{8.0, 100.0}}).ok());
	StreamChanges changes;
	REQUIRE(streamer.update(std::vector<Viewer>{{}}, unlimited, changes).ok());
	REQUIRE(changes.request.size() > 500);
	for (const TileRequest &request : changes.request) {
		CHECK(streamer.finish(request));
	}
	streamer.invalidate(0);
	const std::size_t before = allocation_count();
	for (int frame = 0; frame < 100; ++frame) {
		streamer.invalidate(0);
	}
	CHECK(allocation_count() == before);
}
