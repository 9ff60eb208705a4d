#include "core/streaming/tile_grid.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

using namespace thicket;

namespace {

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

using Name = std::tuple<std::uint32_t, std::uint32_t, int, int>;

Name name_of(const TileKey &key) { return {key.layer, key.grid, key.tile.x, key.tile.y}; }

/// A caller that keeps to the protocol and checks that the streamer does too.
class Stage {
public:
	TileStreamer streamer;
	StreamChanges changes;
	std::map<Name, TileRequest> pending;
	std::map<Name, TileKey> shown;
	std::size_t requested = 0;
	std::size_t dropped = 0;

	explicit Stage(const std::vector<StreamLayer> &layers) { REQUIRE(streamer.set_layers(layers).ok()); }

	/// One update, whose changes are carried out.
	void update(const std::vector<Viewer> &viewers, std::size_t max_pending = unlimited) {
		REQUIRE(streamer.update(viewers, max_pending, changes).ok());
		for (const TileRequest &request : changes.cancel) {
			const auto found = pending.find(name_of(request.key));
			REQUIRE(found != pending.end());
			CHECK(found->second.ticket == request.ticket);
			pending.erase(found);
			CHECK_FALSE(streamer.finish(request));
		}
		for (const TileKey &key : changes.drop) {
			CHECK(shown.erase(name_of(key)) == 1);
			++dropped;
		}
		for (const TileRequest &request : changes.request) {
			CHECK(pending.emplace(name_of(request.key), request).second);
			++requested;
		}
		// What was pending may have been more, under an older limit.
		CHECK((changes.request.empty() || pending.size() <= max_pending));
		CHECK(streamer.counts().pending == pending.size());
		CHECK(streamer.counts().shown == shown.size());
	}

	void finish(const TileRequest &request) {
		CHECK(streamer.finish(request));
		// Not twice.
		CHECK_FALSE(streamer.finish(request));
		shown[name_of(request.key)] = request.key;
		pending.erase(name_of(request.key));
	}

	void finish_all() {
		while (!pending.empty()) {
			finish(TileRequest(pending.begin()->second));
		}
	}

	void settle(const std::vector<Viewer> &viewers) {
		for (int round = 0; round < 3; ++round) {
			update(viewers);
			finish_all();
		}
		update(viewers);
		CHECK(streamer.idle());
	}
};

std::set<std::pair<int, int>> tiles_of(const Stage &stage, std::uint32_t layer) {
	std::set<std::pair<int, int>> result;
	for (const auto &[name, key] : stage.shown) {
		if (key.layer == layer) {
			CHECK(result.emplace(key.tile.x, key.tile.y).second);
		}
	}
	return result;
}

/// Promise 1: all that touches the view of a viewer is there; promise 4: nothing beyond the hysteresis is.
void check_view(const Stage &stage, const std::vector<StreamLayer> &layers, const std::vector<Viewer> &viewers) {
	for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
		const double size = layers[layer].tile_size;
		const auto tiles = tiles_of(stage, layer);
		for (const Viewer &viewer : viewers) {
			const double view = layers[layer].view_distance * viewer.radius_scale;
			const glm::ivec2 first = tile_at(size, viewer.position - view);
			const glm::ivec2 last = tile_at(size, viewer.position + view);
			for (int y = first.y; y <= last.y; ++y) {
				for (int x = first.x; x <= last.x; ++x) {
					if (distance_squared(tile_rect(size, {x, y}), viewer.position) <= view * view) {
						CHECK(tiles.contains({x, y}));
					}
				}
			}
		}
		for (const auto &tile : tiles) {
			const Rect rect = tile_rect(size, {tile.first, tile.second});
			CHECK(std::ranges::any_of(viewers, [&](const Viewer &viewer) {
				// A viewer may have moved an eighth of a tile since the streamer looked.
				const double reach = 1.1 * layers[layer].view_distance * viewer.radius_scale + 1.126 * size;
				return distance_squared(rect, viewer.position) <= reach * reach;
			}));
		}
	}
}

const std::vector<StreamLayer> two_layers{{32.0, 100.0}, {50.0, 220.0}};

} // namespace

TEST_CASE("streaming: tiles round down and share their edges") {
	CHECK(tile_at(10.0, {0.0, 9.999}) == glm::ivec2(0, 0));
	CHECK(tile_at(10.0, {-0.001, 10.0}) == glm::ivec2(-1, 1));
	CHECK(tile_at(10.0, {-10.0, -10.001}) == glm::ivec2(-1, -2));
	CHECK(tile_at(64.0, {5e6, -5e6}) == glm::ivec2(78125, -78125));
	CHECK(tile_at(1.0, {1e300, -1e300}) == glm::ivec2(max_tile_coordinate, -max_tile_coordinate));

	std::mt19937_64 random(1);
	std::uniform_real_distribution<double> along(-5e6, 5e6);
	for (const double size : {0.1, 1.0, 33.3, 64.0, 1000.0 / 3.0}) {
		for (int i = 0; i < 2000; ++i) {
			glm::dvec2 position(along(random), along(random));
			glm::ivec2 tile = tile_at(size, position);
			CHECK(tile_rect(size, tile).contains(position));
			CHECK(tile_rect(size, tile).max.x == tile_rect(size, tile + 1).min.x);
			// Places that lie on an edge belong to the tile that starts there.
			position = tile_rect(size, tile).min;
			CHECK(tile_at(size, position) == tile);
			position.x = std::nextafter(position.x, -1e9);
			CHECK(tile_at(size, position) == glm::ivec2(tile.x - 1, tile.y));
		}
	}
}

TEST_CASE("streaming: the distance to a rectangle is that to its nearest point") {
	const Rect rect{{-1.0, 2.0}, {3.0, 4.0}};
	CHECK(distance_squared(rect, {0.0, 3.0}) == 0.0);
	CHECK(distance_squared(rect, {3.0, 4.0}) == 0.0);
	CHECK(distance_squared(rect, {-3.0, 3.0}) == 4.0);
	CHECK(distance_squared(rect, {6.0, 8.0}) == 25.0);
}

TEST_CASE("streaming: one viewer gets exactly the tiles about it, nearest first, over all layers") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{10.0, -20.0}}};
	CHECK_FALSE(stage.streamer.idle());
	stage.update(viewers);
	CHECK(stage.changes.cancel.empty());
	CHECK(stage.changes.drop.empty());
	CHECK(stage.requested > 50);
	double last = 0.0;
	std::set<std::uint64_t> tickets;
	for (const TileRequest &request : stage.changes.request) {
		const double size = two_layers[request.key.layer].tile_size;
		const Rect expected = tile_rect(size, request.key.tile);
		CHECK(request.rect.min == expected.min);
		CHECK(request.rect.max == expected.max);
		CHECK(tickets.insert(request.ticket).second);
		const double distance = std::sqrt(distance_squared(request.rect, viewers[0].position));
		CHECK(distance >= last);
		CHECK(distance <= two_layers[request.key.layer].view_distance + 0.125 * size);
		last = distance;
	}
	CHECK(stage.changes.request[0].rect.contains(viewers[0].position));
	stage.finish_all();
	check_view(stage, two_layers, viewers);

	// Nothing is asked for twice.
	stage.update(viewers);
	CHECK(stage.changes.empty());
	CHECK(stage.streamer.idle());
	CHECK(stage.streamer.counts().waiting == 0);
}

TEST_CASE("streaming: few at a time come nearest first, from where the viewer is by then") {
	Stage stage({{32.0, 320.0}});
	stage.update({{{0.0, 0.0}}}, 4);
	CHECK(stage.changes.request.size() == 4);
	CHECK(stage.streamer.counts().waiting > 300);
	stage.update({{{0.0, 0.0}}}, 4);
	CHECK(stage.changes.empty());
	stage.finish_all();
	// 200 m on, what lies there comes before what is nearer to the old place.
	stage.update({{{200.0, 0.0}}}, 4);
	REQUIRE(stage.changes.request.size() == 4);
	for (const TileRequest &request : stage.changes.request) {
		CHECK(distance_squared(request.rect, {200.0, 0.0}) < 40.0 * 40.0);
	}
	stage.update({{{200.0, 0.0}}}, 0);
	CHECK(stage.changes.request.empty());
	CHECK_FALSE(stage.streamer.idle());
}

TEST_CASE("streaming: going back and forth loads nothing twice") {
	const std::vector<StreamLayer> layers{{32.0, 200.0}};
	Stage stage(layers);
	stage.settle({{{0.0, 0.0}}});
	stage.settle({{{40.0, 0.0}}});
	const std::size_t once = stage.requested;
	CHECK(stage.dropped == 0);
	for (int turn = 0; turn < 10; ++turn) {
		stage.settle({{{0.0, 0.0}}});
		stage.settle({{{40.0, 0.0}}});
	}
	CHECK(stage.requested == once);
	CHECK(stage.dropped == 0);
	stage.settle({{{500.0, 0.0}}});
	CHECK(stage.dropped > 0);
	check_view(stage, layers, {{{500.0, 0.0}}});
}

TEST_CASE("streaming: a small step costs no look, and still all in view is there") {
	const std::vector<StreamLayer> layers{{40.0, 200.0}};
	Stage stage(layers);
	stage.settle({{{1.0, 1.0}}});
	for (double x = 1.0; x < 300.0; x += 0.7) {
		stage.update({{{x, 1.0}}});
		stage.finish_all();
		check_view(stage, layers, {{{x, 1.0}}});
	}
}

TEST_CASE("streaming: a teleport drops, cancels and loads") {
	Stage stage(two_layers);
	stage.settle({{{0.0, 0.0}}});
	const std::size_t before = stage.shown.size();
	stage.update({{{0.0, 300.0}}}, 5);
	CHECK(stage.pending.size() == 5);
	const std::vector<Viewer> far{{{-5e6, 5e6}}};
	stage.update(far);
	CHECK(stage.changes.cancel.size() == 5);
	CHECK(stage.dropped >= before);
	CHECK(stage.shown.empty());
	CHECK_FALSE(stage.changes.request.empty());
	stage.settle(far);
	check_view(stage, two_layers, far);
}

TEST_CASE("streaming: several viewers, near each other and apart, each with its own scale") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{
			{{0.0, 0.0}, 1.0}, {{60.0, 10.0}, 1.5}, {{-5000.0, 700.0}, 0.25}, {{900.0, 0.0}, 0.0}};
	stage.settle(viewers);
	check_view(stage, two_layers, viewers);
	stage.settle({viewers[2]});
	check_view(stage, two_layers, {viewers[2]});
	// It stays where it is and sees farther, then less.
	for (const double scale : {2.0, 0.5}) {
		stage.settle({{viewers[2].position, scale}});
		check_view(stage, two_layers, {{viewers[2].position, scale}});
	}
	stage.settle({});
	CHECK(stage.shown.empty());
	CHECK(stage.pending.empty());
}

TEST_CASE("streaming: an outdated tile stays on show until its successor is there") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const auto shown = stage.shown;
	const std::size_t requested = stage.requested;
	const std::size_t of_layer_1 = tiles_of(stage, 1).size();
	stage.streamer.invalidate(1);
	CHECK_FALSE(stage.streamer.idle());
	stage.update(viewers);
	CHECK(stage.changes.drop.empty());
	CHECK(stage.changes.request.size() == of_layer_1);
	CHECK(std::ranges::all_of(
			stage.changes.request, [](const TileRequest &request) { return request.key.layer == 1; }));

	// Outdated again before it is done: the first answer is refused, the second one counts.
	const TileRequest early = stage.changes.request[0];
	stage.streamer.invalidate(1);
	CHECK_FALSE(stage.streamer.finish(early));
	stage.update(viewers);
	CHECK(stage.changes.cancel.size() == of_layer_1);
	CHECK(stage.changes.request.size() == of_layer_1);
	CHECK_FALSE(stage.streamer.finish(early));
	stage.settle(viewers);
	CHECK(stage.requested == requested + 2 * of_layer_1);
	CHECK(stage.dropped == 0);
	CHECK(stage.shown.size() == shown.size());

	stage.streamer.invalidate(7);
	stage.update(viewers);
	CHECK(stage.changes.empty());
}

TEST_CASE("streaming: an edit outdates what it touches and no more") {
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

TEST_CASE("streaming: a new view distance keeps what is there") {
	std::vector<StreamLayer> layers = two_layers;
	Stage stage(layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const auto before = stage.shown;
	layers[0].view_distance = 180.0;
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.settle(viewers);
	CHECK(stage.dropped == 0);
	CHECK(std::ranges::includes(
			stage.shown, before, {}, &std::pair<const Name, TileKey>::first, &std::pair<const Name, TileKey>::first));
	check_view(stage, layers, viewers);
	// The same settings again change nothing.
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.update(viewers);
	CHECK(stage.changes.empty());
}

TEST_CASE("streaming: with a new tile size the old tiles stay until the new ones cover them") {
	std::vector<StreamLayer> layers = two_layers;
	Stage stage(layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	const std::uint32_t old_grid = stage.shown.rbegin()->second.grid;
	const std::size_t old_tiles = tiles_of(stage, 1).size();
	const std::size_t other_tiles = tiles_of(stage, 0).size();
	layers[1].tile_size = 70.0;
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.update(viewers);
	CHECK(stage.changes.cancel.empty());
	CHECK(stage.changes.drop.empty());
	CHECK(stage.shown.size() == old_tiles + other_tiles);
	CHECK(std::ranges::all_of(
			stage.changes.request, [](const TileRequest &request) { return request.key.layer == 1; }));

	// One by one: at no time may a place in view be bare that was not.
	while (!stage.pending.empty()) {
		stage.finish(TileRequest(stage.pending.begin()->second));
		stage.update(viewers);
		for (double x = -200.0; x <= 200.0; x += 20.0) {
			for (double y = -90.0; y <= 90.0; y += 20.0) {
				CHECK(std::ranges::any_of(stage.shown, [&](const auto &entry) {
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

TEST_CASE("streaming: a layer that goes takes its tiles along, one that comes brings its own") {
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
	// Gone again while its tiles are being made.
	REQUIRE(stage.streamer.set_layers(std::vector<StreamLayer>{}).ok());
	stage.settle(viewers);
	CHECK(stage.shown.empty());
	REQUIRE(stage.streamer.set_layers(layers).ok());
	stage.settle(viewers);
	check_view(stage, layers, viewers);
}

TEST_CASE("streaming: clear forgets all tiles and keeps the layers") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}};
	stage.settle(viewers);
	stage.update({{{150.0, 0.0}}}, 3);
	const TileRequest late = stage.changes.request.at(0);
	stage.streamer.clear();
	stage.pending.clear();
	stage.shown.clear();
	CHECK_FALSE(stage.streamer.finish(late));
	stage.settle(viewers);
	check_view(stage, two_layers, viewers);
}

TEST_CASE("streaming: bad input is refused by name and value, and the last good state stays") {
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
	refuse_viewer({{0.0, 0.0}, 100.0}, ErrorCode::out_of_range, "viewer.radius_scale", 100.0);
	StreamChanges changes;
	CHECK(stage.streamer.update(std::vector<Viewer>(65), unlimited, changes).code == ErrorCode::out_of_range);

	TileRequest made_up;
	made_up.key.layer = 12;
	CHECK_FALSE(stage.streamer.finish(made_up));
	CHECK_FALSE(stage.streamer.finish({}));
}

TEST_CASE("streaming: the farthest view that is allowed is served") {
	Stage stage({{1.0, 64.0}});
	stage.settle({{{0.5, 0.5}}});
	CHECK(stage.shown.size() > 12000);
	CHECK(stage.shown.size() < 14000);
}

TEST_CASE("streaming: a thousand random steps keep every promise, the same way twice") {
	std::vector<Name> history[2];
	for (std::vector<Name> &log : history) {
		std::mt19937_64 random(77);
		std::uniform_real_distribution<double> unit(0.0, 1.0);
		std::vector<StreamLayer> layers = two_layers;
		Stage stage(layers);
		std::vector<Viewer> viewers{{{0.0, 0.0}}};
		for (int step = 0; step < 1000; ++step) {
			for (Viewer &viewer : viewers) {
				viewer.position += glm::dvec2(unit(random) - 0.5, unit(random) - 0.5) * 30.0;
			}
			switch (random() % 40) {
				case 0: viewers[0].position = glm::dvec2(unit(random), unit(random)) * 1e6; break;
				case 1: viewers.push_back({viewers[0].position + 100.0, unit(random)}); break;
				case 2: viewers.resize(1); break;
				case 3: stage.streamer.invalidate(static_cast<std::uint32_t>(random() % 3)); break;
				case 4: layers[random() % 2].view_distance = 50.0 + 150.0 * unit(random); break;
				case 5: layers[random() % 2].tile_size = 20.0 + 60.0 * unit(random); break;
				case 6: stage.streamer.invalidate(0, {viewers[0].position, viewers[0].position + 80.0}); break;
				default: break;
			}
			REQUIRE(stage.streamer.set_layers(layers).ok());
			stage.update(viewers, 1 + random() % 8);
			for (const TileRequest &request : stage.changes.request) {
				log.push_back(name_of(request.key));
			}
			// Some are made, in any order.
			while (!stage.pending.empty() && random() % 3 != 0) {
				auto any = stage.pending.begin();
				std::advance(any, random() % stage.pending.size());
				stage.finish(TileRequest(any->second));
			}
			if (step % 100 == 99) {
				stage.settle(viewers);
				check_view(stage, layers, viewers);
			}
		}
	}
	CHECK(history[0].size() > 1000);
	CHECK(history[0] == history[1]);
}
