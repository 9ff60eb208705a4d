#include "core/streaming/layer_tiles.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "streaming_stage.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <set>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("streaming: one viewer gets exactly the tiles around it, nearest first, over all layers") {
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
		CHECK(request.space.min == expected.min);
		CHECK(request.space.max == expected.max);
		CHECK(tickets.insert(request.ticket).second);
		const double distance = std::sqrt(distance_squared(request.space, viewers[0].position));
		CHECK(distance >= last);
		CHECK(distance <= two_layers[request.key.layer].view_distance + 0.125 * size);
		last = distance;
	}
	CHECK(stage.changes.request[0].space.contains(viewers[0].position));
	stage.finish_all();
	check_view(stage, two_layers, viewers);

	// A second update requests nothing again.
	stage.update(viewers);
	CHECK(stage.changes.empty());
	CHECK(stage.streamer.idle());
	CHECK(stage.streamer.counts().waiting == 0);
}

TEST_CASE("streaming: a few tiles at a time are requested, nearest to the viewer's current position first") {
	Stage stage({{32.0, 320.0}});
	stage.update({{{0.0, 0.0}}}, 4);
	CHECK(stage.changes.request.size() == 4);
	CHECK(stage.streamer.counts().waiting > 300);
	stage.update({{{0.0, 0.0}}}, 4);
	CHECK(stage.changes.empty());
	stage.finish_all();
	// After the viewer has moved 200 m, tiles around it are requested before tiles near its old
	// position.
	stage.update({{{200.0, 0.0}}}, 4);
	REQUIRE(stage.changes.request.size() == 4);
	for (const TileRequest &request : stage.changes.request) {
		CHECK(distance_squared(request.space, {200.0, 0.0}) < 40.0 * 40.0);
	}
	stage.update({{{200.0, 0.0}}}, 0);
	CHECK(stage.changes.request.empty());
	CHECK_FALSE(stage.streamer.idle());
}

TEST_CASE("streaming: moving back and forth loads no tile twice") {
	const std::vector<StreamLayer> layers{{32.0, 200.0}};
	Stage stage(layers);
	stage.settle({{{0.0, 0.0}}});
	stage.settle({{{40.0, 0.0}}});
	const std::size_t first_requests = stage.requested;
	CHECK(stage.dropped == 0);
	for (int turn = 0; turn < 10; ++turn) {
		stage.settle({{{0.0, 0.0}}});
		stage.settle({{{40.0, 0.0}}});
	}
	CHECK(stage.requested == first_requests);
	CHECK(stage.dropped == 0);
	stage.settle({{{500.0, 0.0}}});
	CHECK(stage.dropped > 0);
	check_view(stage, layers, {{{500.0, 0.0}}});
}

TEST_CASE("streaming: a small step needs no check, and everything in view is still loaded") {
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
	const std::size_t before = stage.visible.size();
	stage.update({{{0.0, 300.0}}}, 5);
	CHECK(stage.pending.size() == 5);
	const std::vector<Viewer> distant{{{-5e6, 5e6}}};
	stage.update(distant);
	CHECK(stage.changes.cancel.size() == 5);
	CHECK(stage.dropped >= before);
	CHECK(stage.visible.empty());
	CHECK_FALSE(stage.changes.request.empty());
	stage.settle(distant);
	check_view(stage, two_layers, distant);
}

TEST_CASE("streaming: several viewers, near each other or apart, each with its own scale, get their tiles") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{
			{{0.0, 0.0}, 1.0}, {{60.0, 10.0}, 1.5}, {{-5000.0, 700.0}, 0.25}, {{900.0, 0.0}, 0.0}};
	stage.settle(viewers);
	check_view(stage, two_layers, viewers);
	stage.settle({viewers[2]});
	check_view(stage, two_layers, {viewers[2]});
	// The viewer stays in place, but sees farther and then less far.
	for (const double scale : {2.0, 0.5}) {
		stage.settle({{viewers[2].position, scale}});
		check_view(stage, two_layers, {{viewers[2].position, scale}});
	}
	stage.settle({});
	CHECK(stage.visible.empty());
	CHECK(stage.pending.empty());
}

TEST_CASE("streaming: a server with 300 players gets all tiles") {
	Stage stage(two_layers);
	std::vector<Viewer> viewers;
	for (int player = 0; player < 300; ++player) {
		viewers.push_back({{1000.0 * (player % 20), 1000.0 * (player / 20)}});
	}
	for (int round = 0; round < 200 && !stage.streamer.idle(); ++round) { // So many tiles require many updates.
		stage.update(viewers);
		stage.finish_all();
	}
	CHECK(stage.streamer.idle());
	check_view(stage, two_layers, viewers);
}

TEST_CASE("streaming: no update is needed until a viewer has moved far enough for other tiles") {
	Stage stage(two_layers);
	const std::vector<Viewer> viewers{{{0.0, 0.0}}, {{500.0, 0.0}}};
	CHECK_FALSE(stage.streamer.follows(viewers));
	stage.settle(viewers);
	CHECK(stage.streamer.follows(viewers));
	const auto moved_viewers = [&](double distance) {
		return std::vector<Viewer>{viewers[0], {viewers[1].position + glm::dvec2(distance, 0.0)}};
	};
	const double slack = slack_tiles * std::min(two_layers[0].tile_size, two_layers[1].tile_size);
	CHECK(stage.streamer.follows(moved_viewers(0.9 * slack)));
	CHECK_FALSE(stage.streamer.follows(moved_viewers(1.1 * slack)));
	CHECK_FALSE(stage.streamer.follows(moved_viewers(1e6)));
	CHECK_FALSE(stage.streamer.follows(std::vector<Viewer>{viewers[0]}));
	CHECK_FALSE(stage.streamer.follows(std::vector<Viewer>{viewers[0], {viewers[1].position, 2.0}}));
	stage.streamer.clear();
	CHECK_FALSE(stage.streamer.follows(viewers));
}

TEST_CASE("streaming: the largest allowed view distance works") {
	Stage stage({{1.0, 64.0}});
	stage.settle({{{0.5, 0.5}}});
	CHECK(stage.visible.size() > 12000);
	const std::size_t max_requests = stage.requested;
	stage.settle({{{0.5, 0.5}, 1e300}});
	CHECK(stage.requested == max_requests);
	CHECK(stage.visible.size() < 14000);
}

TEST_CASE("streaming: a thousand random steps fulfill every guarantee and are reproducible") {
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
			// Finish some tiles, in random order.
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

TEST_CASE("streaming: after a small step since the last check, the result is the same") {
	const double slack = slack_tiles * 40.0;
	TileStreamer streamer;
	REQUIRE(streamer.set_layers(std::vector<StreamLayer>{{40.0, 200.0}}).ok());
	StreamChanges changes;
	const auto requests_at = [&](double x) {
		REQUIRE(streamer.update(std::vector<Viewer>{{{x, 1.0}}}, unlimited, changes).ok());
		return changes.request.size();
	};
	// Find a position just before one that requests tiles.
	double x = 1.0;
	CHECK(requests_at(x) > 50);
	while (requests_at(x + 1.01 * slack) == 0) {
		x += 1.01 * slack;
	}
	const double checked_at = x + 1.01 * slack;
	for (double step = 0.0; step < slack; step += 0.05 * slack) {
		CHECK(requests_at(checked_at + step) == 0);
	}
	double next = checked_at;
	while (requests_at(next += 1.01 * slack) == 0) {}
	CHECK(next < checked_at + 80.0);
}
