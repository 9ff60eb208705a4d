#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// How a layer is streamed.
struct StreamLayer {
	double tile_size = 64.0;      ///< Meters, min_tile_size to max_tile_size.
	double view_distance = 256.0; ///< Meters from a viewer to the nearest point of a tile, 0 to max_view_tiles tiles.

	friend bool operator==(const StreamLayer &, const StreamLayer &) = default;
};

inline constexpr double min_tile_size = 1e-3;
inline constexpr double max_tile_size = 1e9;

/// The farthest that a viewer sees, in tiles, whatever its radius scale: about 13,000 tiles for a viewer and layer.
inline constexpr double max_view_tiles = 64.0;

/// Whether a layer can be streamed so: the ranges of StreamLayer.
Status validate(const StreamLayer &layer);

/// A viewer that moves farther than this between two updates, in meters, has jumped; else it has flown: 1,000 m/s at 20
/// frames a second.
inline constexpr double max_flight_step = 50.0;

/// Someone to stream for.
struct Viewer {
	glm::dvec2 position{0.0}; ///< World meters, finite, within max_tile_coordinate tiles of every layer.
	double radius_scale =
			1.0; ///< Times the view distance of each layer; finite, 0 or more. At most max_view_tiles count.
	double height =
			0.0; ///< World y in meters, finite. Tiles are streamed in the plane: it counts for LODs and thinning.
};

/// Names a tile of a layer. Every tile size that a layer is given starts a new `grid`, a number not used before, so
/// that a tile of the old size and one of the new, both on show for a while, are never taken for each other.
struct TileKey {
	std::uint32_t layer = 0;
	std::uint32_t grid = 0;
	glm::ivec2 tile{0};

	friend bool operator==(const TileKey &, const TileKey &) = default;
};

/// A tile to make. `ticket` is unique: it tells the answer to this request from a late one to an earlier request.
struct TileRequest {
	TileKey key;
	Rect rect; ///< World meters, half-open.
	std::uint64_t ticket = 0;
};

/// What the caller has to do after an update, in this order.
struct StreamChanges {
	std::vector<TileRequest> cancel;  ///< Work under way that nobody wants any more. Answers to it will be refused.
	std::vector<TileKey> drop;        ///< Tiles on show to be taken away.
	std::vector<TileRequest> request; ///< Tiles to make, in this order.

	void clear();
	bool empty() const { return cancel.empty() && drop.empty() && request.empty(); }
};

/// How many tiles are in each state.
struct StreamCounts {
	std::size_t waiting = 0; ///< Wanted, not yet requested.
	std::size_t pending = 0; ///< Requested, not yet answered.
	std::size_t shown = 0;   ///< On show, outdated ones included.
};

/// Says which tiles to make, to show and to drop around which viewers. Pure logic: no clock, no threads, no engine, and
/// the same calls give the same answers in the same order.
///
/// Promises: (1) after an update every tile that touches the view of a viewer is waiting, pending or shown. Where more than
/// a thousand tiles come up at once (a teleport, new viewers) this may take some updates; `idle` is false until then;
/// (2) what is requested is never requested again before it is answered, cancelled or dropped;
/// (3) viewers take turns in requests, and each gets what is nearest to it by then, over all layers;
/// (4) a tile is dropped only beyond `1.1 * view distance + one tile`, so turning back and forth loads nothing twice;
/// (5) an outdated tile stays on show until its successor is there, also where that is outdated itself by then;
/// (6) no far tile comes on show before a near one: what `next_ready` and `may_show` let through is, for one of the viewers
/// that see or keep it, no farther away than the nearest tile of the same layer that this viewer sees and that is missing,
/// one tile, and as far as this viewer has flown since the tile was requested. That last part counts for the viewer that
/// it was requested for, and until that jumps. A tile that takes the place of one on show need not wait;
/// (7) what waits for its turn holds up nothing: it does not count as pending when more is requested, and a tile that
/// cannot be made is out of the way once that is said by `finish`.
class TileStreamer {
public:
	TileStreamer();
	~TileStreamer();
	TileStreamer(TileStreamer &&) noexcept;
	TileStreamer &operator=(TileStreamer &&) noexcept;

	/// Replaces the layers, matched to the old ones by index: a new view distance keeps all tiles, a new tile size
	/// starts a new grid for that layer, a missing layer loses its tiles. Refused settings change nothing, nor does a
	/// call for which memory does not suffice.
	Status set_layers(std::span<const StreamLayer> layers);

	/// What is shown or under way for a layer is outdated (its settings or the ground have changed) and will be requested
	/// again. What is under way is to be shown all the same when it comes, and requested again only then: however fast
	/// changes come, as while a slider is dragged, tiles follow them. A layer that does not exist is ignored.
	void invalidate(std::uint32_t layer);

	/// The same for the tiles that touch `area` (meters) only: an edit under which nothing else changes.
	void invalidate(std::uint32_t layer, const Rect &area);

	/// What is under way for a layer is cancelled and will be requested again: the answers would be of no use.
	void cancel(std::uint32_t layer);

	/// Whether tiles of all layers can be streamed around a viewer: its position is finite and within reach.
	Status check(const Viewer &viewer) const;

	/// Works out what has to change for these viewers, any number of them, and replaces `r_changes` by it. At most `max_pending` tiles are
	/// pending at a time; others wait for their turn, for which each update looks again. No viewers: all is dropped.
	/// A viewer that `check` refuses is refused here, and nothing changes. Costs little while viewers stay within an eighth of a tile. After
	/// ErrorCode::out_of_memory `r_changes` holds what could be worked out, to be done as always; the next update does the
	/// rest. Work to be cancelled may be left out then: its answers are refused all the same.
	Status update(std::span<const Viewer> viewers, std::size_t max_pending, StreamChanges &r_changes);

	/// The tile of a request is made and waits for its turn. False when it comes too late and must be thrown away.
	bool ready(const TileRequest &request);

	/// The tile that comes on show next, of those that are ready; none if all of them have to wait for nearer ones. Viewers
	/// take turns, and each gets what is nearest to it now. The same one may come again until it is finished or cancelled.
	/// None for now where memory does not suffice to tell, as for the next.
	std::optional<TileRequest> next_ready();

	/// Whether a pending tile may come on show now. What takes its time to get there from `next_ready` has to ask again.
	bool may_show(const TileRequest &request);

	/// The last answer to a request: the tile comes on show (or cannot be made: then nothing stands there, until it is
	/// invalidated). True when it is to be put on show, in place of what stands under this key; false when it comes too
	/// late and must be thrown away.
	bool finish(const TileRequest &request);

	/// Forgets all tiles, as if new, and keeps the layers: for a caller that has cleared its display itself. Answers to
	/// requests made before will be refused.
	void clear();

	StreamCounts counts() const;

	/// True when there is nothing to wait for: all that is wanted is shown.
	bool idle() const;

	/// True if the last update was for as many viewers, and none of them has moved or changed its scale since by enough for
	/// other tiles to be wanted: an update for these viewers would keep what `idle` returns.
	bool follows(std::span<const Viewer> viewers) const;

private:
	struct State;
	std::unique_ptr<State> state_;
};

} // namespace thicket
