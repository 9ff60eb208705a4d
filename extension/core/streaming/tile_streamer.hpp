#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

struct StreamLayer {
	double tile_size = 64.0; ///< Width of a tile in meters, min_tile_size to max_tile_size.
	/// Maximum distance in meters from a viewer to a visible tile, 0 to view_tile_limit() tiles.
	double view_distance = 256.0;
	/// The range of heights of a layer on a planet, in world meters. The layer's tiles are cubes,
	/// and distances to them are measured in space. For other layers, the range is infinite: the
	/// tiles cover all heights, and distances to them are measured in the plane.
	double bottom = -std::numeric_limits<double>::infinity();
	double top = std::numeric_limits<double>::infinity();

	/// On a planet, all ground is between `nearest` and `farthest` meters from `center`. Cubes
	/// outside this range are empty and not streamed.
	glm::dvec3 center{0.0};
	double nearest = 0.0;
	double farthest = std::numeric_limits<double>::infinity();

	/// Returns false if a tile certainly has no ground. Always true for tiles that cover all
	/// heights.
	bool may_have_ground(const TileSpace &space) const;

	/// Returns true if the tiles are cubes.
	bool in_space() const { return top < std::numeric_limits<double>::infinity(); }

	/// Returns the maximum view distance in tiles.
	double view_tile_limit() const;

	friend bool operator==(const StreamLayer &, const StreamLayer &) = default;
};

inline constexpr double min_tile_size = 1e-3;
inline constexpr double max_tile_size = 1e9;

/// The maximum view distance in tiles, including the radius scale. A view of this size has about
/// 13,000 tiles per viewer and layer.
inline constexpr double max_view_tiles = 64.0;

/// The same limit for cubes. A view of this size has about 17,000 cubes, with and without ground.
inline constexpr double max_view_tiles_in_space = 16.0;

inline double StreamLayer::view_tile_limit() const { return in_space() ? max_view_tiles_in_space : max_view_tiles; }

/// Returns an error for settings outside the ranges of StreamLayer.
Status validate(const StreamLayer &layer);

/// If a viewer moves more than this distance in meters between two updates, the movement is a jump;
/// otherwise the viewer has flown. The limit corresponds to 1,000 m/s at 20 frames per second.
inline constexpr double max_flight_step = 50.0;

/// A viewer around which tiles are streamed.
struct Viewer {
	glm::dvec2 position{0.0}; ///< World meters, finite, in the range that TileStreamer::check accepts.
	/// Factor for the view distance of each layer, finite, 0 or more. The product with the view
	/// distance is limited to StreamLayer::view_tile_limit().
	double radius_scale = 1.0;
	/// World y in meters, finite. Affects LODs, thinning, and the streaming of tiles that are
	/// cubes.
	double height = 0.0;
};

/// Identifies a tile of a layer. When the tile size of a layer changes, the layer gets a new,
/// unique `grid` number. Tiles of the old and the new size are visible together for a while, so they
/// need different keys.
struct TileKey {
	std::uint32_t layer = 0;
	std::uint32_t grid = 0;
	glm::ivec2 tile{0};
	std::int32_t slab = all_slabs; ///< The slab, if the layer's tiles are cubes.

	friend bool operator==(const TileKey &, const TileKey &) = default;
};

/// A request to generate a tile. The unique `ticket` distinguishes the answer to this request from
/// a late answer to an earlier request.
struct TileRequest {
	TileKey key;
	TileSpace space; ///< The space of the tile, in world meters.
	std::uint64_t ticket = 0;
};

/// The actions that the caller must take after an update, in this order.
struct StreamChanges {
	/// Pending requests that are no longer needed. Their answers will be rejected.
	std::vector<TileRequest> cancel;
	std::vector<TileKey> drop;        ///< Visible tiles to remove.
	std::vector<TileRequest> request; ///< Tiles to generate, most urgent first.

	void clear();
	bool empty() const { return cancel.empty() && drop.empty() && request.empty(); }
};

/// The number of tiles in each state.
struct StreamCounts {
	std::size_t waiting = 0; ///< Tiles that are wanted but not yet requested.
	std::size_t pending = 0; ///< Tiles that are requested but not yet answered.
	std::size_t visible = 0; ///< Visible tiles, including outdated ones.
};

/// Decides which tiles to generate, show and drop around the viewers. The class only makes
/// decisions and is independent of clocks, threads and Godot. The same sequence of calls produces
/// the same results.
///
/// Guarantees:
///  (1) After an update, every tile within a viewer's view distance is waiting, pending or shown.
///      If more than a thousand tiles are added together (a teleport, new viewers), this may take
///      several updates; `idle` is false until then.
///  (2) A requested tile is never requested again before it is answered, canceled or dropped.
///  (3) Viewers take turns. On its turn, a viewer requests the waiting tile of any layer that is
///      nearest to it.
///  (4) A tile is dropped only beyond `1.1 * view distance + one tile`, so moving back and forth
///      loads no tile twice, or in a call to `drop_unseen`.
///  (5) An outdated tile remains visible until its replacement is ready, even if the replacement is
///      outdated by then.
///  (6) Near tiles are shown before far ones. `next_ready` and `may_show` accept a tile only if it
///      is close enough to at least one viewer that sees or keeps it. The limit is the distance of
///      the nearest missing tile of the same layer that this viewer sees, plus one tile. For the
///      viewer that requested the tile, the limit also includes the distance flown since the
///      request, unless that viewer has jumped. A tile that replaces a visible one is not delayed.
///  (7) A ready tile that waits to be shown does not delay other tiles: it does not count toward
///      `max_pending`. A tile that cannot be generated no longer blocks other tiles once the caller
///      reports it with `finish`.
class TileStreamer {
public:
	TileStreamer();
	~TileStreamer();
	TileStreamer(TileStreamer &&) noexcept;
	TileStreamer &operator=(TileStreamer &&) noexcept;

	/// Replaces the layers, which are matched to the old ones by index. A new view distance keeps
	/// all tiles, and a new tile size starts a new grid for that layer. The tiles of a removed
	/// layer are dropped. If settings are invalid or memory runs out, leaves all layers unchanged.
	Status set_layers(std::span<const StreamLayer> layers);

	/// Marks all visible and pending tiles of a layer as outdated, so that they are requested
	/// again. Pending tiles are shown when they arrive and requested again only then. Tiles
	/// therefore still appear during frequent changes, for example while a user drags a slider. A layer
	/// that does not exist is ignored.
	void invalidate(std::uint32_t layer);

	/// Marks only the tiles that touch `area` (world meters) as outdated.
	void invalidate(std::uint32_t layer, const Rect &area);

	/// Drops, in the next update, the visible tiles of all layers that touch `area` (world meters)
	/// and are farther from all viewers than the view distance plus an eighth of a tile. Such tiles
	/// are only kept in case a viewer returns. If memory runs out, some of the tiles remain.
	void drop_unseen(const Rect &area);

	/// Cancels all pending tiles of a layer, for example because their results would be useless.
	/// Tiles that are still needed are requested again.
	void cancel(std::uint32_t layer);

	/// Returns an error for a viewer with values that are not finite, a negative radius scale, or a
	/// position so far away that tile coordinates would overflow.
	Status check(const Viewer &viewer) const;

	/// Computes the changes for any number of viewers and replaces `r_changes` with them. At most
	/// `max_pending` tiles are pending at a time; the others wait. Without viewers, all tiles are
	/// dropped. If `check` returns an error for a viewer, `update` returns it and has no effect. An
	/// update costs little while viewers stay within an eighth of a tile. After
	/// ErrorCode::out_of_memory, `r_changes` contains a partial result, which the caller applies as
	/// usual; the next update completes it. Entries of `cancel` may then be missing, but answers to
	/// these requests are still rejected.
	Status update(std::span<const Viewer> viewers, std::size_t max_pending, StreamChanges &r_changes);

	/// Reports that the tile of a request was generated and is ready to be shown. Returns false if
	/// the tile is no longer needed; the caller must then discard it.
	bool ready(const TileRequest &request);

	/// Returns the next ready tile to show, or none if all ready tiles wait for nearer ones or if
	/// memory runs out. Viewers take turns; on its turn, a viewer's nearest ready tile is returned.
	/// Until a tile is finished or canceled, it may be returned repeatedly.
	std::optional<TileRequest> next_ready();

	/// Returns true if a pending tile may be shown now. Check this again if time passes between
	/// `next_ready` and showing the tile. Returns false if memory runs out.
	bool may_show(const TileRequest &request);

	/// Completes a request. Call this function when the tile is about to be shown or if it could
	/// not be generated. In the latter case, the tile is empty until it is invalidated. Returns
	/// true if the caller must show the tile and replace any tile with the same key. Returns false
	/// if the tile is no longer needed; the caller must then discard it.
	bool finish(const TileRequest &request);

	/// Clears all tiles without reporting them as dropped, for a caller that has cleared its
	/// display itself. The layers remain. Answers to earlier requests will be rejected.
	void clear();

	StreamCounts counts() const;

	/// Returns true if no work is left: all wanted tiles are shown and up to date.
	bool idle() const;

	/// Returns true if the viewers still match the last update. Their number must be the same, and
	/// none of them may have moved or changed its scale enough to need other tiles. An update for
	/// these viewers would not change the result of `idle`.
	bool follows(std::span<const Viewer> viewers) const;

private:
	struct State;
	std::unique_ptr<State> state_;
};

} // namespace thicket
