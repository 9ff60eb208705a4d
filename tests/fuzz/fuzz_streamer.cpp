// Calls a streamer with random sequences of layers, viewers and results. It must either reject a
// call or stay consistent.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/streaming/tile_streamer.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

using Key = std::tuple<std::uint32_t, std::uint32_t, int, int>;

Key key_of(const TileKey &key) { return {key.layer, key.grid, key.tile.x, key.tile.y}; }

/// The client's own record of the tiles, updated with the streamer's changes.
struct Expected {
	std::vector<TileRequest> pending;
	/// Tickets of results that came too late. Their cancellation may still be reported.
	std::set<std::uint64_t> refused_tickets;
	std::set<Key> visible;

	void apply(const StreamChanges &changes) {
		for (const TileRequest &cancelled : changes.cancel) {
			const std::size_t before = pending.size();
			std::erase_if(pending,
					[&](const TileRequest &pending_request) { return pending_request.ticket == cancelled.ticket; });
			require(pending.size() + 1 == before || refused_tickets.contains(cancelled.ticket),
					"only pending requests are cancelled");
		}
		for (const TileKey &dropped : changes.drop) {
			require(visible.erase(key_of(dropped)) == 1, "only visible tiles are dropped");
		}
		for (const TileRequest &request : changes.request) {
			for (const TileRequest &other : pending) {
				require(other.ticket != request.ticket && !(other.key == request.key), "nothing is requested twice");
			}
			require(!request.space.empty() && request.space.finite(), "a request has a rectangle");
			pending.push_back(request);
		}
	}
};

void set_layers(TileStreamer &streamer, Bytes &r_bytes) {
	std::vector<StreamLayer> layers(r_bytes.below(4));
	for (StreamLayer &layer : layers) {
		layer.tile_size = r_bytes.number(8.0, 80.0);
		layer.view_distance = r_bytes.number(0.0, 200.0);
	}
	(void)streamer.set_layers(layers).ok();
}

void update(TileStreamer &streamer, Bytes &r_bytes, Expected &r_expected) {
	std::vector<Viewer> viewers(r_bytes.chance(32) ? r_bytes.below(80) : r_bytes.below(3));
	for (Viewer &viewer : viewers) {
		viewer.position = {r_bytes.number(-300.0, 300.0), r_bytes.number(-300.0, 300.0)};
		viewer.radius_scale = r_bytes.number(0.0, 2.0);
	}
	StreamChanges changes;
	const std::size_t max_count = r_bytes.below(20);
	if (streamer.update(viewers, max_count, changes).ok()) {
		require(changes.request.size() <= max_count, "no more tiles are requested than the limit");
		r_expected.apply(changes);
		const StreamCounts counts = streamer.counts();
		require(counts.pending == r_expected.pending.size(), "pending tiles are counted");
		require(counts.visible == r_expected.visible.size(), "visible tiles are counted");
	} else {
		require(changes.empty(), "a rejected update has no effect");
	}
}

void answer(TileStreamer &streamer, Bytes &r_bytes, Expected &r_expected) {
	if (r_expected.pending.empty()) {
		return;
	}
	if (const auto next = streamer.next_ready()) {
		require(streamer.may_show(*next), "the next tile may be shown");
		require(std::ranges::any_of(r_expected.pending,
						[&](const TileRequest &pending_request) { return pending_request.ticket == next->ticket; }),
				"the next tile is pending");
	}
	const std::size_t request_index = r_bytes.below(static_cast<std::uint32_t>(r_expected.pending.size()));
	const TileRequest request = r_expected.pending[request_index];
	if (r_bytes.chance(3)) {
		(void)streamer.ready(request);
		return;
	}
	r_expected.pending.erase(r_expected.pending.begin() + static_cast<std::ptrdiff_t>(request_index));
	if (streamer.finish(request)) {
		r_expected.visible.insert(key_of(request.key));
	} else {
		r_expected.refused_tickets.insert(request.ticket);
	}
	require(!streamer.finish(request), "a request is finished only once");
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	Bytes bytes(data, size);
	TileStreamer streamer;
	Expected expected;
	set_layers(streamer, bytes);
	for (int step = 0; step < 40; ++step) {
		switch (bytes.below(8)) {
			case 0: set_layers(streamer, bytes); break;
			case 1: streamer.invalidate(bytes.below(5)); break;
			case 2:
				streamer.invalidate(bytes.below(5),
						{{bytes.number(-300.0, 0.0), bytes.number(-300.0, 0.0)},
								{bytes.number(0.0, 300.0), bytes.number(0.0, 300.0)}});
				break;
			case 3:
			case 4: update(streamer, bytes, expected); break;
			default: answer(streamer, bytes, expected); break;
		}
	}
	return 0;
}
