// Tests that the streamer loses no tile, shows none twice, and reaches the same final state,
// whichever allocation fails.

#include "short_of_memory.hpp"
#include "streaming_stage.hpp"

#include <doctest/doctest.h>

#include <random>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A client that follows the streamer's protocol while some allocations fail.
class LowMemoryStage {
public:
	TileStreamer streamer;
	std::map<Name, TileRequest> pending;
	std::map<Name, TileKey> visible;

	/// Updates the streamer. Allocations fail after the first `allowed` ones.
	Status update(const std::vector<Viewer> &viewers, std::size_t allowed) {
		StreamChanges changes;
		Status status;
		{
			const AllocationLimit limit(allowed);
			status = streamer.update(viewers, unlimited, changes);
		}
		for (const TileRequest &request : changes.cancel) {
			pending.erase(name_of(request.key));
			REQUIRE_FALSE(streamer.finish(request));
		}
		for (const TileKey &key : changes.drop) {
			REQUIRE(visible.erase(name_of(key)) == 1);
		}
		for (const TileRequest &request : changes.request) {
			// Replaces a request whose cancellation was not reported.
			pending.insert_or_assign(name_of(request.key), request);
		}
		REQUIRE((status.ok() || status.code == ErrorCode::out_of_memory));
		return status;
	}

	void answer(const TileRequest &request, std::size_t allowed) {
		bool accepted = false;
		{
			const AllocationLimit limit(allowed);
			accepted = streamer.ready(request) && streamer.finish(request);
		}
		if (accepted) {
			visible[name_of(request.key)] = request.key;
		}
	}

	void answer_some(std::mt19937 &random, std::size_t allowed) {
		std::vector<TileRequest> answered;
		for (const auto &[name, request] : pending) {
			if (random() % 2 == 0) {
				answered.push_back(request);
			}
		}
		for (const TileRequest &request : answered) {
			pending.erase(name_of(request.key));
			answer(request, allowed);
		}
	}

	void settle(const std::vector<Viewer> &viewers) {
		for (int round = 0; round < 6; ++round) {
			REQUIRE(update(viewers, unlimited).ok());
			const auto all = std::exchange(pending, {});
			for (const auto &[name, request] : all) {
				answer(request, unlimited);
			}
		}
		REQUIRE(streamer.idle());
		REQUIRE(streamer.counts().visible == visible.size());
	}
};

std::vector<Name> names_of(const std::map<Name, TileKey> &visible) {
	std::vector<Name> names;
	for (const auto &[name, key] : visible) {
		names.push_back(name);
	}
	return names;
}

/// Checks guarantee 1 of the streamer: every tile within the view distance is shown.
void check_all_in_view(const LowMemoryStage &stage, std::uint32_t layer, const std::vector<Viewer> &viewers) {
	std::set<std::pair<int, int>> tiles;
	for (const auto &[name, key] : stage.visible) {
		if (key.layer == layer) {
			tiles.emplace(key.tile.x, key.tile.y);
		}
	}
	const double size = two_layers[layer].tile_size;
	const double view = two_layers[layer].view_distance;
	for (const Viewer &viewer : viewers) {
		const glm::ivec2 first = tile_at(size, viewer.position - view);
		const glm::ivec2 last = tile_at(size, viewer.position + view);
		for (int y = first.y; y <= last.y; ++y) {
			for (int x = first.x; x <= last.x; ++x) {
				const bool touches = distance_squared(tile_rect(size, {x, y}), viewer.position) <= view * view;
				REQUIRE((!touches || tiles.contains({x, y})));
			}
		}
	}
}

} // namespace

TEST_CASE("out of memory: the next update completes an incomplete one") {
	const std::vector<Viewer> near_viewers{{.position = {3.0, 4.0}}};
	const std::vector<Viewer> far_viewers{{.position = {240.0, -90.0}}, {.position = {-500.0, 80.0}}};
	LowMemoryStage twin;
	REQUIRE(twin.streamer.set_layers(two_layers).ok());
	twin.settle(near_viewers);
	twin.settle(far_viewers);
	std::size_t failures = 0;
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		CAPTURE(allowed);
		LowMemoryStage stage;
		REQUIRE(stage.streamer.set_layers(two_layers).ok());
		bool is_complete = stage.update(near_viewers, allowed).ok();
		stage.settle(near_viewers);
		is_complete = stage.update(far_viewers, allowed).ok() && is_complete;
		stage.settle(far_viewers);
		REQUIRE(names_of(stage.visible) == names_of(twin.visible));
		failures += is_complete ? 0 : 1;
		done = is_complete ? 1 : 0;
	}
	CHECK(failures > 20);
}

TEST_CASE("out of memory: a streamer that is always short of memory reaches the same end") {
	std::mt19937 random(5);
	for (int repeat = 0; repeat < 20; ++repeat) {
		LowMemoryStage stage;
		REQUIRE(stage.streamer.set_layers(two_layers).ok());
		std::vector<Viewer> viewers{{.position = {0.0, 0.0}}, {.position = {900.0, 0.0}}};
		for (int step = 0; step < 60; ++step) {
			viewers[0].position += glm::dvec2(random() % 30, random() % 20);
			viewers[1].position = random() % 8 == 0 ? glm::dvec2(random() % 2000, 0.0) : viewers[1].position;
			static_cast<void>(stage.update(viewers, random() % 40));
			stage.answer_some(random, random() % 3);
			{
				const AllocationLimit limit(random() % 3);
				const auto layer = static_cast<std::uint32_t>(random() % 2);
				switch (random() % 6) {
					case 0: stage.streamer.invalidate(layer, {{0.0, 0.0}, {300.0, 300.0}}); break;
					case 1: stage.streamer.cancel(layer); break;
					case 2: static_cast<void>(stage.streamer.next_ready()); break;
					default: break;
				}
			}
		}
		stage.settle(viewers);
		for (std::uint32_t layer = 0; layer < two_layers.size(); ++layer) {
			check_all_in_view(stage, layer, viewers);
		}
	}
}

TEST_CASE("out of memory: settings of layers are applied completely or not at all") {
	const std::vector<Viewer> viewers{{.position = {3.0, 4.0}}};
	const std::vector<StreamLayer> other_layers{{20.0, 100.0}, {50.0, 220.0}, {64.0, 100.0}};
	std::size_t failures = 0;
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		CAPTURE(allowed);
		LowMemoryStage stage;
		REQUIRE(stage.streamer.set_layers(two_layers).ok());
		stage.settle(viewers);
		const auto before = names_of(stage.visible);
		Status status;
		{
			const AllocationLimit limit(allowed);
			status = stage.streamer.set_layers(other_layers);
			done = limit.reached() ? 0 : 1;
		}
		if (!status.ok()) {
			++failures;
			REQUIRE(status.code == ErrorCode::out_of_memory);
			REQUIRE(std::string(status.property) == "layers");
			stage.settle(viewers);
			REQUIRE(names_of(stage.visible) == before);
			REQUIRE(stage.streamer.set_layers(other_layers).ok());
		}
		stage.settle(viewers);
		REQUIRE(names_of(stage.visible) != before);
	}
	CHECK(failures > 0);
}
