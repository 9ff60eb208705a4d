#pragma once

#include "core/drawing/tile_key_order.hpp"

#include <cstdint>
#include <optional>
#include <set>

namespace thicket {

/// A divided tile is merged in favor of a waiting tile only if it is farther from the viewers by
/// this factor. Otherwise, two tiles at similar distances would replace each other endlessly.
inline constexpr double yield_factor = 1.1;

/// Decides which visible tiles are divided into cells for drawing while the number of multimeshes
/// is limited. Merging a tile means drawing it as a whole again. The class only makes decisions,
/// like TileStreamer: the caller uploads and shows the cells of one tile at a time, and reports
/// when it is done.
///
/// Guarantees:
///  (1) The waiting tile nearest to a viewer is divided first.
///  (2) No division begins that could exceed the limit. If enough multimeshes can be freed by
///      merging divided tiles that are farther away by the factor `yield_factor`, these tiles are
///      merged first, farthest first. Otherwise they stay divided, and the waiting tile is postponed.
///  (3) A postponed tile is considered again once multimeshes have been freed.
///  (4) While more multimeshes exist than the limit allows, the farthest divided tile is merged
///      before anything else.
///  (5) If tiles and viewers do not change, the queue eventually has no more work.
class DivisionQueue {
public:
	/// Provides the current state of the visible tiles.
	class Tiles {
	public:
		virtual ~Tiles() = default;

		/// Returns the distance in meters, 0 or more, from the nearest viewer to the tile's box.
		virtual double distance(const TileKey &key) const = 0;

		/// `displayed_division` returns the current division of a tile, and `wanted_division` the
		/// division for its distance. A division is the number of cells along an edge; 1 if the
		/// tile is drawn as a whole.
		virtual std::uint32_t displayed_division(const TileKey &key) const = 0;
		virtual std::uint32_t wanted_division(const TileKey &key) const = 0;

		/// `multimeshes` returns a tile's current number of multimeshes. `multimesh_bound` returns
		/// the maximum number with `cells_per_edge` cells along an edge.
		virtual std::uint64_t multimeshes(const TileKey &key) const = 0;
		virtual std::uint64_t multimesh_bound(const TileKey &key, std::uint32_t cells_per_edge) const = 0;
	};

	/// The total number of multimeshes of all tiles.
	struct Multimeshes {
		std::uint64_t count = 0; ///< Current number of multimeshes.
		std::uint64_t limit = 0;
	};

	struct Division {
		TileKey key;
		std::uint32_t cells_per_edge = 1;
	};

	/// Returns the division for a tile that has not been uploaded yet: `wanted_division` or 1.
	/// `total` includes the multimeshes of the tile. The tile is divided from the start only if
	/// `total` does not exceed the limit. In addition, the tile must replace a visible one, or no
	/// other tile may be waiting to be uploaded. If these conditions are not met, the tile can be
	/// divided later, once it is visible.
	static std::uint32_t first_division(
			std::uint32_t wanted_division, Multimeshes total, bool replaces_visible_tile, bool others_wait);

	/// Queues a visible tile if its `displayed_division` differs from `wanted_division`. Does nothing
	/// if the tile is already queued or is being divided.
	void choose(const TileKey &key, std::uint32_t displayed_division, std::uint32_t wanted_division);

	/// Chooses the next division, which is current until `finish` or `cancel`. Call this function
	/// only while there is no current division. Returns nothing if no waiting tile can be divided;
	/// the queue is then empty. Takes O(waiting tiles + divided tiles) time for each tile that it
	/// considers.
	std::optional<Division> begin(const Tiles &tiles, Multimeshes total);

	const std::optional<Division> &current() const { return current_; }
	bool is_current(const TileKey &key) const { return current_ && current_->key == key; }

	/// Reports that the current division is now visible.
	void finish();

	/// Cancels the current division. Only another call to `choose` queues the tile again.
	void cancel() { current_.reset(); }

	/// Reports that a tile is visible with this division, for example because it was divided from
	/// the start.
	void show(const TileKey &key, std::uint32_t cells_per_edge);

	/// Removes a tile. Its division must not be the current one.
	void remove(const TileKey &key);

	/// Reports that multimeshes were freed and queues the postponed tiles again.
	void capacity_gained(const Tiles &tiles);

	/// Returns true if there is a current division, or if `begin` may find one.
	bool has_work(Multimeshes total) const { return current_ || !waiting_tiles_.empty() || must_shrink(total); }

	void clear();

private:
	struct FartherTiles {
		const TileKey *farthest = nullptr; ///< The farthest of these tiles; null if there is none.
		std::uint64_t freeable_count = 0;  ///< Multimeshes that merging all of these tiles would free.
	};
	bool must_shrink(Multimeshes total) const { return total.count > total.limit && !divided_tiles_.empty(); }
	FartherTiles farther_than(double distance, const Tiles &tiles) const;
	TileKey nearest_waiting(const Tiles &tiles) const;
	bool begin_with(const TileKey &key, const Tiles &tiles, Multimeshes total);

	std::optional<Division> current_;
	std::set<TileKey, TileKeyOrder> waiting_tiles_;
	std::set<TileKey, TileKeyOrder> postponed_tiles_; ///< Tiles that were postponed because of the limit.
	std::set<TileKey, TileKeyOrder> divided_tiles_;   ///< Visible tiles that are divided.
};

} // namespace thicket
