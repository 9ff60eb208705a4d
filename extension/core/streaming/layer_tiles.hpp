#pragma once

#include "core/base/rect.hpp"
#include "core/streaming/tile_disc.hpp"
#include "core/streaming/tile_queue.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "core/streaming/tile_table.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// How far a viewer may move, in tiles, before its tiles are checked again. The search for wanted tiles reaches out farther by this
/// distance, so that no visible tile is missed in between.
inline constexpr double slack_tiles = 0.125;

/// A tile is kept up to this many view distances, plus one tile.
inline constexpr double keep_factor = 1.1;

/// The maximum number of new tiles per look, plus those of one viewer. A teleport of many viewers takes several looks.
inline constexpr std::size_t max_new = 1500;

/// A viewer as tracked by the streamer.
struct TrackedViewer {
	Viewer now;
	double flown = 0.0;     ///< Meters covered by all steps that were not jumps.
	double jumped_at = 0.0; ///< `flown` after the last jump.

	/// Meters flown since `then`, an earlier value of `flown`. 0 if the viewer has jumped since.
	double flown_since(double then) const { return then >= jumped_at ? flown - then : 0.0; }
};

/// The tiles of one layer and the state of each. Part of TileStreamer, which documents the states.
class LayerTiles {
public:
	/// A tile and its distance to a viewer.
	struct Candidate {
		double distance_squared = 0.0;
		std::uint32_t slot = 0;
	};

	LayerTiles(std::uint32_t layer, const StreamLayer &settings, std::uint32_t grid) :
			layer_(layer), settings_(settings), grid_(grid) {}

	const StreamLayer &settings() const { return settings_; }
	StreamCounts counts() const;
	std::size_t made_count() const { return made_.size(); }
	bool has_retired() const { return !retired_.empty(); }

	/// Applies new settings. A new tile size retires the visible tiles, cancels all other tiles, and starts `new_grid`.
	void configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes);

	/// Adds the maximum number of entries that `configure` and `clear` will append.
	void add_room(std::size_t &r_cancel, std::size_t &r_drop) const;

	/// Allocates the memory that `configure` needs in this layer.
	void make_room();

	/// Marks tiles that touch `area` as outdated. Pending tiles stay pending and are outdated when they arrive.
	void invalidate(const Rect &area);

	/// Cancels pending tiles. They wait to be requested again.
	void cancel_all(StreamChanges &r_changes);

	/// Cancels and drops everything.
	void clear(StreamChanges &r_changes);

	/// Drops everything without recording changes.
	void forget();

	/// Determines which tiles are wanted, kept and gone. Returns false, at no cost, if no viewer's view distance has changed and none has
	/// moved by more than `slack_tiles`. Otherwise the cost depends on the amount of change. Adds to `r_new` the number of tiles that
	/// were not known before. Once there are `max_new` of them, leaves the other viewers for the next look. Throws std::bad_alloc;
	/// `r_changes` then contains the finished part, and the next look starts over.
	bool look(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes);

	/// True if the last look left viewers for the next one. No tile is shown until then.
	bool behind() const { return behind_; }

	/// See TileStreamer::follows.
	bool follows(std::span<const Viewer> viewers) const;

	/// Drops retired tiles if no tile below them is missing: if each tile there is visible or out of view.
	void drop_covered(StreamChanges &r_changes);

	/// The waiting tile nearest to a viewer.
	std::optional<Candidate> next_waiting(std::size_t viewer);

	/// Turns a waiting tile into a pending one, for a viewer.
	TileRequest request(std::uint32_t slot, std::uint64_t ticket, std::uint32_t viewer, double flown);

	/// See TileStreamer::ready. Returns false if the tile is no longer needed.
	bool ready(const TileRequest &request);

	/// The nearest tile to a viewer that is ready and whose turn it is.
	std::optional<Candidate> next_ready(std::size_t viewer, const TrackedViewer &tracked);
	TileRequest request_of(std::uint32_t slot) const;

	/// Whether a pending tile may be shown now.
	bool may_show(const TileRequest &request, std::span<const TrackedViewer> viewers);

	/// The number of ready tiles that wait for nearer ones.
	std::size_t count_held(std::span<const TrackedViewer> viewers);

	/// See TileStreamer::finish.
	bool finish(const TileRequest &request);

private:
	/// A viewer's view at the time of the last look.
	struct Sight {
		glm::dvec2 position{0.0};
		double seen = -1.0; ///< Meters, including the slack. Below 0 for a viewer that is new or gone.
		bool moved = false; ///< The viewer has moved, and `leave` has not been called yet.
		TileDisc view;
		TileDisc keep;
		TileDisc old_view;
		TileDisc old_keep;
		TileQueue queue; ///< The viewer's tiles that are not current, and for a while others.
	};

	/// A visible tile from a grid of a different size, kept until tiles of the current grid cover it.
	struct Retired {
		TileKey key;
		Rect rect;
	};

	double view_of(const Viewer &viewer) const;
	bool is_where(const Sight &sight, const Viewer *viewer) const;
	void move(Sight &sight, const TrackedViewer *viewer);
	void enter(Sight &sight);
	void leave(const Sight &sight, StreamChanges &r_changes);
	bool seen(glm::ivec2 at) const;
	bool kept(glm::ivec2 at) const;
	void add_to_queues(std::uint32_t slot);
	void queue_up(std::uint32_t slot) noexcept;
	bool measure(const Sight &sight, TileQueue::Entry &entry) const;
	void sort(Sight &sight);
	template <class Fits>
	const TileQueue::Entry *first(Sight &sight, std::size_t cursor, Fits &&fits);
	double first_missing(Sight &sight);
	bool is_turn(std::size_t viewer, const TrackedViewer &tracked, const StreamedTile &tile, double distance_squared);
	bool is_anyones_turn(const StreamedTile &tile, std::span<const TrackedViewer> viewers);
	/// Changes a tile and updates the counts.
	template <class Change>
	void change(std::uint32_t slot, Change &&apply);
	void erase(std::uint32_t slot);
	void forget_made(std::uint32_t slot);
	void cancel(std::uint32_t slot, StreamChanges &r_changes);
	void release(std::uint32_t slot, StreamChanges &r_changes);
	bool is_missing_under(const Rect &rect) const;
	bool look_at_all(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes);
	void begin_anew();
	void leave_all(StreamChanges &r_changes);
	std::uint32_t find_pending(const TileRequest &request) const;
	TileKey key(glm::ivec2 at) const { return {layer_, grid_, at}; }
	Rect rect(glm::ivec2 at) const;

	std::uint32_t layer_;
	StreamLayer settings_;
	std::uint32_t grid_;
	StreamCounts counts_; ///< Without retired tiles.
	TileTable tiles_;
	std::vector<Sight> sights_;   ///< By viewer.
	std::size_t first_sight_ = 0; ///< Where the next look starts.
	bool behind_ = false;
	bool torn_ = false;               ///< Memory ran out: the queues are incomplete, or a look was interrupted.
	bool sweeping_ = false;           ///< After that, all tiles must be checked once every viewer was handled.
	std::vector<std::uint32_t> made_; ///< Slots of ready tiles.
	std::vector<Retired> retired_;
};

template <class Change>
void LayerTiles::change(std::uint32_t slot, Change &&apply) {
	StreamedTile &tile = tiles_[slot];
	const auto count = [this, &tile](std::size_t once) {
		counts_.waiting += tile.exists && tile.waiting() ? once : 0;
		counts_.pending += tile.exists && tile.ticket != 0 ? once : 0;
		counts_.shown += tile.exists && tile.shown ? once : 0;
	};
	count(std::size_t{0} - 1);
	apply(tile);
	count(1);
}

} // namespace thicket
