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

/// How far a viewer may move, in tiles, before its tiles are looked at again; wanted tiles are looked for so much
/// farther out that none in view is missed in between.
inline constexpr double slack_tiles = 0.125;

/// A tile is kept out to this many view distances, and one tile more.
inline constexpr double keep_factor = 1.1;

/// So many tiles may come up in a look, and those of one viewer more: a teleport of many viewers takes several.
inline constexpr std::size_t max_new = 1500;

/// A viewer as the streamer follows it.
struct TrackedViewer {
	Viewer now;
	double flown = 0.0;     ///< Meters, by all steps so far that were no jumps.
	double jumped_at = 0.0; ///< `flown` after the last jump.

	/// How far it has flown since `then`, a value that `flown` had; 0 if it has jumped since.
	double flown_since(double then) const { return then >= jumped_at ? flown - then : 0.0; }
};

/// The tiles of one layer and what is known of each. A part of TileStreamer, which says what the states mean.
class LayerTiles {
public:
	/// A tile and how far a viewer is from it.
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

	/// Takes new settings; a new tile size retires what is on show, cancels the rest, and starts `new_grid`.
	void configure(const StreamLayer &settings, std::uint32_t new_grid, StreamChanges &r_changes);

	/// What `configure` and `clear` will add at most, told in advance.
	void add_room(std::size_t &r_cancel, std::size_t &r_drop) const;

	/// Takes the memory that `configure` needs in this layer.
	void make_room();

	/// What touches `area` is outdated. What is under way stays so, and is outdated when it comes.
	void invalidate(const Rect &area);

	/// Cancels what is under way; it waits to be requested again.
	void cancel_all(StreamChanges &r_changes);

	/// Cancels and drops everything.
	void clear(StreamChanges &r_changes);

	/// The same, without a word.
	void forget();

	/// Finds out which tiles are wanted, kept and gone. Returns false, at no cost, if no viewer sees less or more than it
	/// did or has moved by more than `slack_tiles`. What it costs else depends on what is not what it was. Adds to `r_new`
	/// the tiles that were not known before; once there are `max_new` of them, viewers are left for the next look.
	/// Throws std::bad_alloc; what was done is in `r_changes` then, and the next look begins anew.
	bool look(std::span<const TrackedViewer> viewers, std::size_t &r_new, StreamChanges &r_changes);

	/// True if the last look left viewers for the next one. Nothing comes on show until then.
	bool behind() const { return behind_; }

	/// See TileStreamer::follows.
	bool follows(std::span<const Viewer> viewers) const;

	/// Drops retired tiles under which nothing is missing: all is there, or out of view.
	void drop_covered(StreamChanges &r_changes);

	/// The nearest tile to a viewer that waits to be requested.
	std::optional<Candidate> next_waiting(std::size_t viewer);

	/// Turns a waiting tile into a pending one, for a viewer.
	TileRequest request(std::uint32_t slot, std::uint64_t ticket, std::uint32_t viewer, double flown);

	/// See TileStreamer::ready. False if nobody waits for it any more.
	bool ready(const TileRequest &request);

	/// The nearest tile to a viewer that lies ready and whose turn it is.
	std::optional<Candidate> next_ready(std::size_t viewer, const TrackedViewer &tracked);
	TileRequest request_of(std::uint32_t slot) const;

	/// Whether it is the turn of a tile that is under way.
	bool may_show(const TileRequest &request, std::span<const TrackedViewer> viewers);

	/// How many tiles lie ready and have to wait for nearer ones.
	std::size_t count_held(std::span<const TrackedViewer> viewers);

	/// See TileStreamer::finish.
	bool finish(const TileRequest &request);

private:
	/// What a viewer sees, as it was when looked at last.
	struct Sight {
		glm::dvec2 position{0.0};
		double seen = -1.0; ///< Meters, with the slack; below 0 for a viewer that is new or has gone.
		bool moved = false; ///< The next three are older than the first.
		TileDisc view;
		TileDisc keep;
		TileDisc old_view;
		TileDisc old_keep;
		TileQueue queue; ///< Its tiles that are not current, and for a while others.
	};

	/// On show from a grid of another size, until tiles of the present one cover it.
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
	/// Changes a tile and keeps count.
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
	StreamCounts counts_; ///< Without what is retired.
	TileTable tiles_;
	std::vector<Sight> sights_;   ///< By viewer.
	std::size_t first_sight_ = 0; ///< The one to begin the next look with.
	bool behind_ = false;
	bool torn_ = false;     ///< Memory ended: not all that waits is in the queues, or a look was left half done.
	bool sweeping_ = false; ///< And all tiles have to be looked at once every viewer has been.
	std::vector<std::uint32_t> made_; ///< Slots of tiles that lie ready.
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
