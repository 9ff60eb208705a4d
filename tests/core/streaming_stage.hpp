#pragma once

// Helpers for streamer tests.

#include "core/base/tile_grid.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <vector>

namespace thicket::test {

inline constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

using Name = std::tuple<std::uint32_t, std::uint32_t, int, int>;

inline Name name_of(const TileKey &key) { return {key.layer, key.grid, key.tile.x, key.tile.y}; }

/// A client that follows the streamer's protocol and checks that the streamer also follows it.
class Stage {
public:
	TileStreamer streamer;
	StreamChanges changes;
	std::map<Name, TileRequest> pending;
	std::map<Name, TileKey> visible;
	std::set<std::uint64_t> ready; ///< Tickets of pending tiles that are ready.
	std::size_t requested = 0;
	std::size_t dropped = 0;

	explicit Stage(const std::vector<StreamLayer> &layers) { REQUIRE(streamer.set_layers(layers).ok()); }

	/// Updates the streamer once and applies all changes.
	void update(const std::vector<Viewer> &viewers, std::size_t max_pending = unlimited) {
		REQUIRE(streamer.update(viewers, max_pending, changes).ok());
		for (const TileRequest &request : changes.cancel) {
			const auto match = pending.find(name_of(request.key));
			REQUIRE(match != pending.end());
			CHECK(match->second.ticket == request.ticket);
			pending.erase(match);
			ready.erase(request.ticket);
			CHECK_FALSE(streamer.finish(request));
		}
		for (const TileKey &key : changes.drop) {
			CHECK(visible.erase(name_of(key)) == 1);
			++dropped;
		}
		for (const TileRequest &request : changes.request) {
			CHECK(pending.emplace(name_of(request.key), request).second);
			++requested;
		}
		// More tiles may be pending if an earlier update had a higher limit. Tiles that are ready
		// do not count toward the limit.
		CHECK((changes.request.empty() || pending.size() - ready.size() <= max_pending));
		CHECK(streamer.counts().pending == pending.size());
		CHECK(streamer.counts().visible == visible.size());
	}

	void finish(const TileRequest &request) {
		CHECK(streamer.finish(request));
		// A request can be finished only once.
		CHECK_FALSE(streamer.finish(request));
		visible[name_of(request.key)] = request.key;
		pending.erase(name_of(request.key));
		ready.erase(request.ticket);
	}

	void mark_ready(const TileRequest &request) {
		CHECK(streamer.ready(request));
		ready.insert(request.ticket);
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

inline std::set<std::pair<int, int>> tiles_of(const Stage &stage, std::uint32_t layer) {
	std::set<std::pair<int, int>> result;
	for (const auto &[name, key] : stage.visible) {
		if (key.layer == layer) {
			CHECK(result.emplace(key.tile.x, key.tile.y).second);
		}
	}
	return result;
}

/// Checks guarantees 1 and 4 of the streamer: every tile within the view distance of a viewer is
/// visible, and no tile beyond the hysteresis is.
inline void check_view(const Stage &stage, const std::vector<StreamLayer> &layers, const std::vector<Viewer> &viewers) {
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
				// A viewer may have moved up to an eighth of a tile since the streamer last
				// checked.
				const double max_distance = 1.1 * layers[layer].view_distance * viewer.radius_scale + 1.126 * size;
				return distance_squared(rect, viewer.position) <= max_distance * max_distance;
			}));
		}
	}
}

inline const std::vector<StreamLayer> two_layers{{32.0, 100.0}, {50.0, 220.0}};

} // namespace thicket::test
