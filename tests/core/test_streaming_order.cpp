// Tests that no far tile becomes visible before a near one, regardless of how viewers move and workers are
// delayed.

#include "core/streaming/layer_tiles.hpp"
#include "core/streaming/work_order.hpp"
#include "streaming_stage.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A stage that checks, from the streamer's results alone, that tiles become visible in the correct
/// order.
class OrderlyStage : public Stage {
public:
	using Stage::Stage;

	std::map<Name, std::vector<double>>
			traveled_then; ///< The values of `traveled` when each pending tile was requested.
	std::vector<double> traveled;
	std::vector<Viewer> current_viewers;
	std::size_t visible_in_order = 0;

	void move(const std::vector<Viewer> &viewers, std::size_t max_pending) {
		traveled.resize(viewers.size());
		for (std::size_t i = 0; i < std::min(current_viewers.size(), viewers.size()); ++i) {
			const glm::dvec2 step = viewers[i].position - current_viewers[i].position;
			traveled[i] += std::hypot(step.x, step.y);
			if (std::hypot(step.x, step.y) > max_flight_step) {
				// After a jump, earlier requests may be shown in any order with regard to this
				// viewer.
				for (auto &[name, previous_traveled] : traveled_then) {
					previous_traveled.resize(std::max(previous_traveled.size(), i + 1));
					previous_traveled[i] = std::numeric_limits<double>::infinity();
				}
			}
		}
		current_viewers = viewers;
		update(viewers, max_pending);
		for (const TileRequest &request : changes.request) {
			traveled_then[name_of(request.key)] = traveled;
		}
	}

	/// Shows up to `max_count` tiles that may be shown, like a renderer with spare time.
	void show(const std::vector<StreamLayer> &layers, std::size_t max_count = unlimited) {
		for (std::size_t count = 0; count < max_count; ++count) {
			const auto next = streamer.next_ready();
			if (!next) {
				return;
			}
			CHECK(streamer.may_show(*next));
			check_turn(layers[next->key.layer], *next);
			finish(*next);
			++visible_in_order;
		}
	}

private:
	/// Checks by brute force that it is the tile's turn. For at least one viewer, no missing tile
	/// may be nearer by more than the tile size plus the distance flown since the request.
	void check_turn(const StreamLayer &layer, const TileRequest &next) {
		if (visible.contains(name_of(next.key))) {
			return;
		}
		bool turn = false;
		for (std::size_t i = 0; i < current_viewers.size() && !turn; ++i) {
			const double view = layer.view_distance * current_viewers[i].radius_scale;
			const std::vector<double> &previous_traveled = traveled_then[name_of(next.key)];
			const double leeway = layer.tile_size +
					(i < previous_traveled.size() ? std::max(traveled[i] - previous_traveled[i], 0.0) : 0.0) + 1e-9;
			turn = std::sqrt(distance_squared(next.space, current_viewers[i].position)) <=
					nearest_missing(layer, next.key, current_viewers[i].position, view) + leeway;
		}
		CHECK(turn);
	}

	double nearest_missing(const StreamLayer &layer, TileKey key, glm::dvec2 from, double view) const {
		double nearest = std::numeric_limits<double>::infinity();
		const glm::ivec2 first = tile_at(layer.tile_size, from - view);
		const glm::ivec2 last = tile_at(layer.tile_size, from + view);
		for (key.tile.y = first.y; key.tile.y <= last.y; ++key.tile.y) {
			for (key.tile.x = first.x; key.tile.x <= last.x; ++key.tile.x) {
				const double distance = std::sqrt(distance_squared(tile_rect(layer.tile_size, key.tile), from));
				if (distance <= view && !visible.contains(name_of(key))) {
					nearest = std::min(nearest, distance);
				}
			}
		}
		return nearest;
	}
};

/// Makes up to `max_count` pending tiles ready, in random order with a preference for the latest
/// requests.
void make_some_ready(OrderlyStage &stage, std::mt19937_64 &random, std::size_t max_count) {
	for (std::size_t finished_count = 0; finished_count < max_count && !stage.pending.empty(); ++finished_count) {
		auto any = stage.pending.begin();
		std::advance(any, random() % stage.pending.size());
		if (random() % 2 == 0) {
			any = std::ranges::max_element(stage.pending, {}, [](const auto &entry) { return entry.second.ticket; });
		}
		stage.mark_ready(TileRequest(any->second));
	}
}

} // namespace

TEST_CASE("streaming order: tiles finished in any order are shown by distance, to within a tile") {
	std::mt19937_64 random(5);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (int world = 0; world < 12; ++world) {
		std::vector<StreamLayer> layers{{16.0, 90.0}, {10.0 + 20.0 * std::abs(unit(random)), 120.0}};
		OrderlyStage stage(layers);
		std::vector<Viewer> viewers{{glm::dvec2(unit(random), unit(random)) * 1e5}};
		if (world % 3 == 1) {
			viewers.push_back({viewers[0].position + 70.0, 0.6});
			viewers.push_back({viewers[0].position - 5000.0, 1.3});
		}
		for (int step = 0; step < 120; ++step) {
			for (Viewer &viewer : viewers) {
				viewer.position += glm::dvec2(unit(random), unit(random)) * 6.0;
			}
			if (step % 40 == 39) {
				viewers[random() % viewers.size()].position += glm::dvec2(unit(random), unit(random)) * 300.0;
			}
			if (random() % 50 == 0) {
				stage.streamer.invalidate(static_cast<std::uint32_t>(random() % 2));
			}
			stage.move(viewers, 1 + random() % 24);
			make_some_ready(stage, random, random() % 12);
			stage.show(layers, random() % 4 == 0 ? 2 : unlimited);
		}
		CHECK(stage.visible_in_order > 200);
	}
}

TEST_CASE("streaming order: a waiting tile does not delay workers") {
	const std::vector<StreamLayer> layers{{16.0, 160.0}};
	OrderlyStage stage(layers);
	const std::vector<Viewer> viewers{{{8.0, 8.0}}};
	stage.move(viewers, 6);
	const TileRequest nearest = stage.changes.request[0];
	// All requests except the nearest become ready, repeatedly. Workers get more requests,
	// regardless of the number of ready tiles.
	for (int round = 0; round < 200; ++round) {
		for (const auto &[name, request] : stage.pending) {
			if (request.ticket != nearest.ticket) {
				stage.mark_ready(request);
			}
		}
		stage.show(layers);
		stage.move(viewers, 6);
	}
	CHECK(stage.streamer.counts().waiting == 0);
	for (const auto &[name, key] : stage.visible) {
		CHECK(distance_squared(tile_rect(16.0, key.tile), viewers[0].position) <= 16.0 * 16.0);
	}
	// If the nearest tile fails, its request is finished as well, and all the other tiles are
	// shown.
	stage.finish(nearest);
	stage.show(layers);
	CHECK(stage.streamer.idle());
}

TEST_CASE("streaming order: several viewers get tiles in turn, even if one requests very many") {
	const std::vector<StreamLayer> layers{{16.0, 100.0}};
	OrderlyStage stage(layers);
	// The first viewer does not move. The second one jumps in every frame, so its near tiles are
	// always missing.
	std::vector<Viewer> viewers{{{0.0, 0.0}}, {{1e4, 0.0}}};
	for (int frame = 0; frame < 60; ++frame) {
		viewers[1].position.x += 1000.0;
		stage.move(viewers, 8);
		for (const TileRequest &request : stage.changes.request) {
			stage.mark_ready(request);
		}
		stage.show(layers);
	}
	std::size_t around_the_first = 0;
	for (const auto &[name, key] : stage.visible) {
		around_the_first += tile_rect(16.0, key.tile).min.x < 500.0 ? 1 : 0;
	}
	CHECK(around_the_first > 120);
}

TEST_CASE("streaming order: at 1000 m/s with slow workers, near tiles keep coming") {
	const std::vector<StreamLayer> layers{{16.0, 128.0}, {64.0, 512.0}};
	OrderlyStage stage(layers);
	std::vector<std::vector<TileRequest>> made_later(4); // A worker takes three frames to generate a tile.
	std::size_t frames_without[2] = {0, 0};
	std::size_t longest[2] = {0, 0};
	for (std::size_t frame = 0; frame < 600; ++frame) {
		const double x = static_cast<double>(frame) * 1000.0 / 60.0;
		stage.move({{{x, 0.3 * x}}}, 24);
		made_later[frame % 4] = stage.changes.request;
		for (const TileRequest &request : made_later[(frame + 1) % 4]) {
			if (stage.pending.contains(name_of(request.key)) &&
					stage.pending[name_of(request.key)].ticket == request.ticket) {
				stage.mark_ready(request);
			}
		}
		const std::size_t visible = stage.visible_in_order;
		stage.show(layers, 5); // Many more tiles come into view.
		for (std::size_t layer = 0; layer < 2; ++layer) {
			const bool any = std::ranges::any_of(stage.visible, [&](const auto &entry) {
				const TileKey &key = entry.second;
				const double size = layers[layer].tile_size;
				return key.layer == layer &&
						distance_squared(tile_rect(size, key.tile), stage.current_viewers[0].position) <=
						16.0 * size * size;
			});
			frames_without[layer] = any ? 0 : frames_without[layer] + 1;
			longest[layer] = frame > 10 ? std::max(longest[layer], frames_without[layer]) : 0;
		}
		CHECK((frame < 10 || stage.visible_in_order > visible));
	}
	CHECK(longest[0] == 0);
	CHECK(longest[1] == 0);
}

TEST_CASE("streaming order: a ready tile that is no longer requested is rejected") {
	Stage stage({{16.0, 100.0}});
	stage.update({{{0.0, 0.0}}}, 4);
	const std::vector<TileRequest> requests = stage.changes.request;
	REQUIRE(requests.size() == 4);
	CHECK(stage.streamer.ready(requests[0]));
	CHECK(stage.streamer.ready(requests[0]));
	CHECK_FALSE(stage.streamer.ready({requests[0].key, requests[0].space, 0}));
	CHECK_FALSE(stage.streamer.may_show({{7, 0, {0, 0}}, requests[0].space, 1}));
	stage.update({{{1e5, 0.0}}}, 4);
	CHECK_FALSE(stage.streamer.ready(requests[1]));
	CHECK_FALSE(stage.streamer.may_show(requests[0]));
	CHECK_FALSE(stage.streamer.next_ready().has_value());
}

TEST_CASE("streaming order: a teleport of many viewers is spread over updates and ends correctly") {
	std::vector<StreamLayer> layers;
	for (int i = 0; i < 6; ++i) {
		layers.push_back({10.0 + i, 200.0});
	}
	std::vector<Viewer> viewers;
	for (int i = 0; i < 16; ++i) {
		viewers.push_back({{1000.0 * i, -500.0}});
	}
	Stage stage(layers);
	int updates = 0;
	std::size_t known_count = 0;
	do {
		stage.update(viewers);
		const StreamCounts counts = stage.streamer.counts();
		CHECK(counts.pending + counts.visible - known_count <= max_new + 2000);
		known_count = counts.pending + counts.visible;
		stage.finish_all();
		REQUIRE(++updates < 200);
	} while (!stage.streamer.idle());
	CHECK(updates > 10);
	check_view(stage, layers, viewers);
	// Removing a viewer renumbers the remaining viewers, but no tile around them is generated
	// again.
	const std::size_t requested = stage.requested;
	viewers.erase(viewers.begin() + 3);
	stage.settle(viewers);
	CHECK(stage.requested == requested);
	check_view(stage, layers, viewers);
}

TEST_CASE("work order: entries are sorted by distance to the nearest viewer, for all viewers equally") {
	const auto square = [](double x) {
		return Rect{{x, 0.0}, {x + 1.0, 1.0}};
	};
	const std::vector<TileSpace> areas{
			square(50.0), square(1010.0), square(20.0), square(1001.0), square(1030.0), square(3.0)};
	std::vector<std::size_t> order;
	work_order(areas, std::vector<Viewer>{{{0.0, 0.0}}, {{1000.0, 0.0}}}, order);
	CHECK(order == std::vector<std::size_t>{5, 3, 2, 1, 4, 0});
	work_order(areas, {}, order);
	CHECK(order == std::vector<std::size_t>{0, 1, 2, 3, 4, 5});
	work_order({}, std::vector<Viewer>{{{0.0, 0.0}}}, order);
	CHECK(order.empty());
}
