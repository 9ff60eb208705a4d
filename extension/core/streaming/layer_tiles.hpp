#pragma once

#include "core/base/rect.hpp"
#include "core/base/tile_grid.hpp"
#include "core/streaming/tile_ball.hpp"
#include "core/streaming/tile_queue.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "core/streaming/tile_table.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// Distance in tiles that a viewer may move before its tiles are checked again. The view is
/// extended by this distance, so that no tile is missed in between.
inline constexpr double slack_tiles = 0.125;

/// A tile, once requested, is kept up to this many view distances plus one tile.
inline constexpr double keep_factor = 1.1;

/// Once a call to LayerTiles::update_viewers has found this number of new tiles, it leaves the
/// remaining viewers to the next call. After many viewers teleport, several calls are needed.
inline constexpr std::size_t max_new = 1500;

/// A viewer and the distance that it has traveled.
struct TrackedViewer {
	Viewer now;
	double traveled = 0.0;  ///< Meters traveled in steps that were not jumps.
	double last_jump = 0.0; ///< Value of `traveled` after the last jump.

	/// Returns the distance in meters that the viewer has traveled since `traveled` had the value
	/// `then`, or 0 if the viewer has jumped since.
	double traveled_since(double then) const { return then >= last_jump ? traveled - then : 0.0; }
};

/// The tiles of one layer and their states. Part of TileStreamer, which defines the terms.
class LayerTiles {
public:
	/// A tile and its squared distance to a viewer.
	struct Candidate {
		double distance_squared = 0.0;
		std::uint32_t slot = 0;
	};

	LayerTiles(std::uint32_t layer, const StreamLayer &settings, std::uint32_t grid) :
			layer_(layer), settings_(settings), grid_(grid) {}

	const StreamLayer &settings() const { return settings_; }
	StreamCounts counts() const;
	std::size_t ready_count() const { return ready_slots_.size(); }
	bool has_retired() const { return !retired_.empty(); }

	/// Applies new settings. A new tile size starts the grid `new_grid`, retires the visible tiles
	/// and cancels pending ones.
	void configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes);

	/// Adds, to each argument, the maximum number of entries that `configure` or `clear` appends to
	/// the list of that name.
	void add_max_changes(std::size_t &r_cancel, std::size_t &r_drop) const;

	/// Allocates the memory that `configure` needs in this object.
	void reserve_retired();

	/// Marks tiles that touch `area` as outdated. Pending tiles remain pending and are outdated
	/// when they arrive.
	void invalidate(const Rect &area);

	/// Drops the visible tiles that touch `area` and were outside every view in the last call to
	/// `update_viewers`. May throw std::bad_alloc; some of the tiles then remain.
	void drop_unseen(const Rect &area, StreamChanges &r_changes);

	/// Cancels all pending tiles. Tiles that are still needed wait to be requested again.
	void cancel_all(StreamChanges &r_changes);

	/// Cancels all pending tiles and drops all visible ones.
	void clear(StreamChanges &r_changes);

	/// Clears everything without recording changes.
	void forget();

	/// Updates the wanted and kept tiles for the viewers' positions. Returns false, at little cost,
	/// if no view distance has changed and no viewer has moved by more than `slack_tiles`.
	/// Otherwise the cost depends on the amount of change. The number of new tiles is added to
	/// `r_new`. Once `r_new` reaches `max_new`, the remaining viewers are left to the next call.
	/// May throw std::bad_alloc; `r_changes` then contains the finished part, and the next call
	/// starts over.
	bool update_viewers(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes);

	/// Returns true if the last call to `update_viewers` left viewers to the next one. No tile may
	/// be shown until then.
	bool behind() const { return behind_; }

	/// Returns true if the viewers still match; see TileStreamer::follows.
	bool follows(std::span<const Viewer> viewers) const;

	/// Drops each retired tile under which no wanted tile is missing.
	void drop_covered(StreamChanges &r_changes);

	/// Returns the waiting tile nearest to a viewer, if there is one.
	std::optional<Candidate> next_waiting(std::size_t viewer);

	/// Makes a waiting tile pending and returns its request. `traveled` is the viewer's
	/// TrackedViewer::flown.
	TileRequest request(std::uint32_t slot, std::uint64_t ticket, std::uint32_t viewer, double traveled);

	/// See TileStreamer::ready. Returns false if the tile is no longer needed.
	bool ready(const TileRequest &request);

	/// Returns the ready tile nearest to a viewer that may be shown now, if there is one.
	std::optional<Candidate> next_ready(std::size_t viewer, const TrackedViewer &tracked);
	TileRequest request_of(std::uint32_t slot) const;

	/// Returns true if a pending tile may be shown now.
	bool may_show(const TileRequest &request, std::span<const TrackedViewer> viewers);

	/// Returns the number of ready tiles that wait for nearer ones.
	std::size_t count_waiting(std::span<const TrackedViewer> viewers);

	/// Completes a request; see TileStreamer::finish.
	bool finish(const TileRequest &request);

private:
	/// A viewer's view and queue as of the last call to `update_viewers`.
	struct ViewerState {
		glm::dvec3 position{0.0}; ///< See position_of().
		/// View distance in meters, including the slack. Negative for a new or removed viewer.
		double seen = -1.0;
		bool moved = false; ///< True if the viewer has moved and `leave` has not been called since.
		TileBall view;
		TileBall keep;
		TileBall old_view;
		TileBall old_keep;
		TileQueue queue; ///< The viewer's tiles that are not current. May temporarily contain other tiles.
	};

	/// A visible tile of a previous grid, kept until tiles of the current grid cover it.
	struct Retired {
		TileKey key;
		TileSpace space;
	};

	double view_of(const Viewer &viewer) const;
	glm::dvec3 position_of(const Viewer &viewer) const;
	bool is_where(const ViewerState &state, const Viewer *viewer) const;
	void move(ViewerState &state, const TrackedViewer *viewer);
	void enter(ViewerState &state);
	void leave(const ViewerState &state, StreamChanges &r_changes);
	bool seen(glm::ivec3 at) const;
	bool in_keep_range(glm::ivec3 at) const;
	void add_to_queues(std::uint32_t slot);
	void queue_up(std::uint32_t slot) noexcept;
	bool measure(const ViewerState &state, TileQueue::Entry &entry) const;
	void sort(ViewerState &state);
	template <class Fits>
	const TileQueue::Entry *first(ViewerState &state, std::size_t cursor, Fits &&fits);
	double first_missing(ViewerState &state);
	bool is_next_for_viewer(
			std::size_t viewer, const TrackedViewer &tracked, const StreamedTile &tile, double distance_squared);
	bool is_next_for_any_viewer(const StreamedTile &tile, std::span<const TrackedViewer> viewers);
	/// Changes a tile and updates the counts.
	template <class Change>
	void change(std::uint32_t slot, Change &&apply);
	void erase(std::uint32_t slot);
	void forget_ready(std::uint32_t slot);
	void cancel(std::uint32_t slot, StreamChanges &r_changes);
	void release(std::uint32_t slot, StreamChanges &r_changes);
	bool is_missing_under(const TileSpace &under) const;
	bool check_all(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes);
	void begin_anew();
	void leave_all(StreamChanges &r_changes);
	std::uint32_t find_pending(const TileRequest &request) const;
	TileKey key(glm::ivec3 at) const { return {layer_, grid_, glm::ivec2(at), at.z}; }
	TileSpace space(glm::ivec3 at) const;

	std::uint32_t layer_;
	StreamLayer settings_;
	std::uint32_t grid_;
	StreamCounts counts_; ///< Counts of tiles, without retired ones.
	TileTable tiles_;
	std::vector<ViewerState> viewer_states_; ///< One entry per viewer.
	std::size_t first_viewer_ = 0;           ///< The viewer with which the next call to `update_viewers` starts.
	bool behind_ = false;
	bool torn_ = false;                      ///< True after memory ran out, because the queues may then be incomplete.
	bool sweeping_ = false;                  ///< True if all tiles must be checked once every viewer has been handled.
	std::vector<std::uint32_t> ready_slots_; ///< Slots of ready tiles.
	std::vector<Retired> retired_;
};

template <class Change>
void LayerTiles::change(std::uint32_t slot, Change &&apply) {
	StreamedTile &tile = tiles_[slot];
	const auto count = [this, &tile](std::size_t once) {
		counts_.waiting += tile.exists && tile.waiting() ? once : 0;
		counts_.pending += tile.exists && tile.ticket != 0 ? once : 0;
		counts_.visible += tile.exists && tile.visible ? once : 0;
	};
	count(std::size_t{0} - 1);
	apply(tile);
	count(1);
}

} // namespace thicket
