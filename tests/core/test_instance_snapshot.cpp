// Tests snapshots of a world, which several threads query concurrently while the world changes.

#include "core/query/instance_snapshot.hpp"
#include "flat_world.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

using Tiles = std::vector<std::shared_ptr<const CompactTile>>;

std::vector<std::uint64_t> ids_in(const InstanceSnapshot &snapshot, const Rect &rect) {
	std::vector<PlacedInstance> results;
	CHECK(snapshot.answer([&](const InstanceQuery &query) { return query.in_rect(rect, {}, results); }).ok());
	std::vector<std::uint64_t> ids;
	for (const PlacedInstance &instance : results) {
		ids.push_back(instance.id);
	}
	return ids;
}

/// Returns a function that generates tiles on any thread and counts them.
TileMaker counting_maker(FlatWorld &flat, std::atomic<std::size_t> &r_generated) {
	return [&](std::span<const WorldTile> tiles, Tiles &r_tiles) -> Status {
		r_tiles.clear();
		for (const WorldTile &tile : tiles) {
			r_tiles.push_back(flat.make(tile.tile));
			++r_generated;
		}
		return {};
	};
}

} // namespace

TEST_CASE("instance snapshot: threads get the results of the snapshot while the world changes") {
	FlatWorld flat;
	InstanceState state;
	std::atomic<std::size_t> generated = 0;
	flat.world.set_maker(counting_maker(flat, generated));
	flat.world.set_state(&state);
	const Rect rect{{-20.0, -20.0}, {20.0, 20.0}};
	std::vector<PlacedInstance> standing_instances;
	const auto query_world = [&] {
		std::vector<PlacedInstance> results;
		CHECK(flat.world.answer([&](const InstanceQuery &query) { return query.in_rect(rect, {}, results); }).ok());
		return results;
	};
	standing_instances = query_world();
	REQUIRE(standing_instances.size() > 100);
	REQUIRE(state.remove(standing_instances[0].id));
	AddedInstance added;
	added.layer = flat.world.layers()[0].set.layer;
	std::uint64_t added_id = 0;
	REQUIRE(state.add(added, added_id).ok());
	const std::size_t expected = query_world().size();
	REQUIRE(expected == standing_instances.size());
	const InstanceSnapshot snapshot(flat.world, state.share(), counting_maker(flat, generated));
	std::atomic<std::size_t> wrong_count = 0;
	std::vector<std::thread> threads;
	for (int thread = 0; thread < 4; ++thread) {
		threads.emplace_back([&] {
			for (int round = 0; round < 20; ++round) {
				std::vector<PlacedInstance> results;
				const Status status =
						snapshot.answer([&](const InstanceQuery &query) { return query.in_rect(rect, {}, results); });
				wrong_count += status.ok() && results.size() == expected ? 0 : 1;
			}
		});
	}
	for (std::size_t i = 1; i < standing_instances.size(); ++i) {
		CHECK(state.remove(standing_instances[i].id));
	}
	CHECK(state.remove(added_id));
	flat.world.clear();
	for (std::thread &thread : threads) {
		thread.join();
	}
	CHECK(wrong_count == 0);
	CHECK(query_world().empty());
	CHECK(ids_in(snapshot, rect).size() == expected);
}

TEST_CASE("instance snapshot: cached tiles are reused, and missing tiles are generated once") {
	FlatWorld flat;
	std::atomic<std::size_t> generated = 0;
	flat.world.keep({0, {0, 0}}, flat.make({0, 0}));
	const InstanceSnapshot snapshot(flat.world, std::nullopt, counting_maker(flat, generated));
	const double size = flat.world.layers()[0].tile_size;
	const Rect known_rect{{1.0, 1.0}, {size - 1.0, size - 1.0}};
	const Rect unknown{{size + 1.0, 1.0}, {2.0 * size - 1.0, size - 1.0}};
	CHECK_FALSE(ids_in(snapshot, known_rect).empty());
	const std::size_t for_known = generated;
	const std::vector<std::uint64_t> first = ids_in(snapshot, unknown);
	const std::size_t for_unknown = generated;
	CHECK(for_unknown > for_known);
	CHECK(ids_in(snapshot, unknown) == first);
	CHECK(generated == for_unknown);
}

TEST_CASE("instance snapshot: only queries that need an unavailable tile fail") {
	FlatWorld flat;
	flat.world.keep({0, {0, 0}}, flat.make({0, 0}));
	const InstanceSnapshot snapshot(flat.world, std::nullopt, [](std::span<const WorldTile> tiles, Tiles &r_tiles) {
		r_tiles.assign(tiles.size(), nullptr);
		return Status::missing("ground", "Ask elsewhere");
	});
	const double size = flat.world.layers()[0].tile_size;
	std::vector<PlacedInstance> results;
	const auto answer = [&](double from) {
		const Rect rect{{from, 0.4 * size}, {from + 1.0, 0.6 * size}};
		return snapshot.answer([&](const InstanceQuery &query) { return query.in_rect(rect, {}, results); });
	};
	CHECK(answer(0.5 * size).ok());
	CHECK(answer(1.5 * size).code == ErrorCode::missing);
	CHECK(results.empty());
}
