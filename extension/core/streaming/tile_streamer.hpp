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

struct StreamLayer {
	double tile_size = 64.0;      ///< Meters, min_tile_size to max_tile_size.
	double view_distance = 256.0; ///< Meters from a viewer to the nearest point of a tile, 0 to max_view_tiles tiles.

	friend bool operator==(const StreamLayer &, const StreamLayer &) = default;
};

inline constexpr double min_tile_size = 1e-3;
inline constexpr double max_tile_size = 1e9;

/// The maximum view distance in tiles, whatever the radius scale: about 13,000 tiles per viewer and layer.
inline constexpr double max_view_tiles = 64.0;

/// Whether a layer's settings lie in the ranges of StreamLayer.
Status validate(const StreamLayer &layer);

/// A viewer that moves farther than this between two updates, in meters, has jumped. Otherwise it has flown. Corresponds to 1,000 m/s at
/// 20 frames a second.
inline constexpr double max_flight_step = 50.0;

/// A viewer around which tiles are streamed.
struct Viewer {
	glm::dvec2 position{0.0}; ///< World meters, finite, within max_tile_coordinate tiles of every layer.
	double radius_scale =
			1.0; ///< Multiplies the view distance of each layer. Finite, 0 or more; capped at max_view_tiles.
	double height =
			0.0; ///< World y in meters, finite. Affects only LODs and thinning; tiles are streamed in the plane.
};

/// Identifies a tile of a layer. Every tile size set for a layer starts a new `grid`, a number not used before. A tile of the old size
/// and one of the new size, both visible for a while, are therefore never confused.
struct TileKey {
	std::uint32_t layer = 0;
	std::uint32_t grid = 0;
	glm::ivec2 tile{0};

	friend bool operator==(const TileKey &, const TileKey &) = default;
};

/// A tile to generate. `ticket` is unique. It distinguishes the answer to this request from a late answer to an earlier one.
struct TileRequest {
	TileKey key;
	Rect rect; ///< World meters, half-open.
	std::uint64_t ticket = 0;
};

/// The work for the caller after an update, in this order.
struct StreamChanges {
	std::vector<TileRequest> cancel;  ///< Pending work that is no longer needed. Answers to it will be refused.
	std::vector<TileKey> drop;        ///< Visible tiles to remove.
	std::vector<TileRequest> request; ///< Tiles to generate, in this order.

	void clear();
	bool empty() const { return cancel.empty() && drop.empty() && request.empty(); }
};

/// The number of tiles in each state.
struct StreamCounts {
	std::size_t waiting = 0; ///< Wanted, not yet requested.
	std::size_t pending = 0; ///< Requested, not yet answered.
	std::size_t shown = 0;   ///< Visible, including outdated ones.
};

/// Decides which tiles to generate, show and drop around the viewers. Pure logic without clock, threads or engine. The same calls return
/// the same results in the same order.
///
/// Promises:
///  (1) After an update, every tile that touches the view of a viewer is waiting, pending or shown. If more than a thousand tiles are
/// added together (a teleport, new viewers), this may take several updates; `idle` is false until then.
///  (2) A requested tile is never requested again before it is answered, cancelled or dropped.
///  (3) Viewers take turns in requests, and each gets the tile nearest to it at that time, over all layers.
///  (4) A tile is dropped only beyond `1.1 * view distance + one tile`, so turning back and forth loads no tile twice.
///  (5) An outdated tile stays visible until its successor is ready, even if the successor is itself outdated by then.
///  (6) No far tile is shown before a near one. A tile accepted by `next_ready` and `may_show` is, for one of the viewers that see or
/// keep it, at most this far away: the distance of the nearest missing tile of the same layer that this viewer sees, plus one tile, plus
/// the distance that this viewer has flown since the tile was requested. The last part applies only to the viewer that it was requested
/// for, and only until that viewer jumps. A tile that replaces a visible one need not wait.
///  (7) A tile that waits for its turn delays no other: it does not count as pending when further tiles are requested. A tile that cannot
/// be generated stops blocking others once the caller reports it with `finish`.
class TileStreamer {
public:
	TileStreamer();
	~TileStreamer();
	TileStreamer(TileStreamer &&) noexcept;
	TileStreamer &operator=(TileStreamer &&) noexcept;

	/// Replaces the layers, matched to the old ones by index. A new view distance keeps all tiles, a new tile size starts a new grid for
	/// that layer, and a missing layer loses its tiles. Refused settings change nothing, nor does a call that runs out of memory.
	Status set_layers(std::span<const StreamLayer> layers);

	/// Marks the visible and pending tiles of a layer as outdated (its settings or the ground have changed), so that they will be
	/// requested again. Pending tiles are still shown when they arrive, and requested again only then. Tiles therefore keep up even with
	/// fast changes, such as a dragged slider. A layer that does not exist is ignored.
	void invalidate(std::uint32_t layer);

	/// Marks only the tiles that touch `area` (meters) as outdated: for an edit that changes nothing elsewhere.
	void invalidate(std::uint32_t layer, const Rect &area);

	/// Cancels the pending tiles of a layer and requests them again, because their answers would be useless.
	void cancel(std::uint32_t layer);

	/// Returns whether tiles of all layers can be streamed around a viewer. Its position must be finite and within
	/// reach.
	Status check(const Viewer &viewer) const;

	/// Computes the necessary changes for any number of viewers and replaces `r_changes` with them. At most
	/// `max_pending` tiles are pending at a time. Other tiles wait for their turn, which each update checks again.
	/// Without viewers, all tiles are dropped. If `check` refuses a viewer, this method refuses it as well, and nothing
	/// changes. Costs little while viewers stay within an eighth of a tile. After ErrorCode::out_of_memory, `r_changes`
	/// contains a partial result, which the caller applies as usual; the next update completes it. Work to cancel may
	/// then be missing; its answers are refused all the same.
	Status update(std::span<const Viewer> viewers, std::size_t max_pending, StreamChanges &r_changes);

	/// Reports that the tile of a request is generated and waits for its turn. Returns false if it is too late; the caller must then
	/// discard the tile.
	bool ready(const TileRequest &request);

	/// The next ready tile to show, or none if all ready tiles wait for nearer ones. Viewers take turns, and each gets the tile
	/// nearest to it now. May return the same tile again until it is finished or cancelled. Returns none if memory does not suffice to
	/// decide.
	std::optional<TileRequest> next_ready();

	/// Returns whether a pending tile may be shown now. Call this again if showing takes time after `next_ready`.
	/// Returns false if memory does not suffice.
	bool may_show(const TileRequest &request);

	/// The final answer to a request: the tile is shown, or cannot be generated and stays empty until it is
	/// invalidated. Returns true if the caller must show the tile, in place of the tile with the same key. Returns
	/// false if the answer is too late; the caller must then discard the tile.
	bool finish(const TileRequest &request);

	/// Forgets all tiles and keeps the layers, for a caller that has cleared its display itself. Answers to earlier requests will be
	/// refused.
	void clear();

	StreamCounts counts() const;

	/// True if nothing is left to do: all wanted tiles are shown.
	bool idle() const;

	/// True if the last update had the same number of viewers, and none of them has moved or changed its scale enough to need different
	/// tiles. An update for these viewers would not change the result of `idle`.
	bool follows(std::span<const Viewer> viewers) const;

private:
	struct State;
	std::unique_ptr<State> state_;
};

} // namespace thicket
