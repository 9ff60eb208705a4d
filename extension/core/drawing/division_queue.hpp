#pragma once

#include "core/drawing/tile_key_order.hpp"

#include <cstdint>
#include <optional>
#include <set>

namespace thicket {

/// A tile in cells is drawn as a whole in favor of a waiting tile only if it is farther from the viewers by this
/// factor. So two tiles at similar distances do not replace each other endlessly.
inline constexpr double gives_way = 1.1;

/// Decides which visible tiles are drawn in cells while the number of multimeshes is limited. Pure logic, like TileStreamer: the caller
/// uploads the cells of one tile after another, shows them and reports it.
///
/// Promises:
///  (1) The waiting tile nearest to a viewer is divided first.
///  (2) No division begins that could exceed the limit. If tiles in cells that are farther by the factor `gives_way` can free enough, they
/// are drawn as a whole first, the farthest before the others. Otherwise none of them changes, and the tile stops waiting.
///  (3) A tile that was refused is considered again once multimeshes have been freed.
///  (4) While more multimeshes exist than the limit allows, the farthest tile in cells becomes whole, whatever else waits.
///  (5) While tiles and viewers stay where they are, the divisions come to an end.
class DivisionQueue {
public:
	/// The visible tiles, as the caller draws them now.
	class Tiles {
	public:
		virtual ~Tiles() = default;

		/// The distance from the nearest viewer to a tile's box. Meters, 0 or more.
		virtual double distance(const TileKey &key) const = 0;

		/// The current division of a tile, and the division that its distance requires: cells along a side, 1 if the
		/// tile is drawn as a whole.
		virtual std::uint32_t shown(const TileKey &key) const = 0;
		virtual std::uint32_t wanted(const TileKey &key) const = 0;

		/// The number of a tile's multimeshes now, and the largest possible number with `across` cells along a side.
		virtual std::uint64_t multimeshes(const TileKey &key) const = 0;
		virtual std::uint64_t most_multimeshes(const TileKey &key, std::uint32_t across) const = 0;
	};

	/// The multimeshes of all tiles together.
	struct Multimeshes {
		std::uint64_t count = 0; ///< The current number.
		std::uint64_t limit = 0;
	};

	struct Division {
		TileKey key;
		std::uint32_t across = 1;
	};

	/// The division for a tile that is not uploaded yet: `wanted`, or 1. The tile is divided from the start if `then`
	/// multimeshes, with its own, do not exceed the limit, and if it replaces a visible tile or no other tile waits for
	/// its upload. Otherwise it may be divided once it is visible.
	static std::uint32_t first_division(
			std::uint32_t wanted, Multimeshes then, bool replaces_visible_tile, bool others_wait);

	/// Queues a visible tile if its division `shown` is not the wanted one. Does nothing if the tile is already queued
	/// or is being divided.
	void choose(const TileKey &key, std::uint32_t shown, std::uint32_t wanted);

	/// Chooses the next division, which is the current one until `finish` or `cancel`. Call it only while no division
	/// is current. If no waiting tile can be divided, returns nothing, and the queue is then empty. O(waiting tiles +
	/// tiles in cells) for each tile that it considers.
	std::optional<Division> begin(const Tiles &tiles, Multimeshes all);

	const std::optional<Division> &current() const { return current_; }
	bool is_current(const TileKey &key) const { return current_ && current_->key == key; }

	/// The current division is visible now.
	void finish();

	/// Gives up the current division. The tile is queued again only when it is chosen again.
	void cancel() { current_.reset(); }

	/// Reports that a tile is visible with this division, for example because it was uploaded in cells.
	void show(const TileKey &key, std::uint32_t across);

	/// A tile is gone; its division must not be the current one.
	void remove(const TileKey &key);

	/// Multimeshes were freed: tiles that were refused may be divided now.
	void room_gained(const Tiles &tiles);

	/// True if there is a current division, or `begin` has something to consider.
	bool has_work(Multimeshes all) const { return current_ || !waiting_.empty() || must_shrink(all); }

	void clear();

private:
	struct FartherTiles {
		const TileKey *farthest = nullptr; ///< The tile in cells farthest from the viewers; null if there is none.
		std::uint64_t spare = 0;           ///< Multimeshes that would be freed if all such tiles were drawn as a whole.
	};
	bool must_shrink(Multimeshes all) const { return all.count > all.limit && !divided_.empty(); }
	FartherTiles farther_than(double distance, const Tiles &tiles) const;
	TileKey nearest_waiting(const Tiles &tiles) const;
	bool begin_with(const TileKey &key, const Tiles &tiles, Multimeshes all);

	std::optional<Division> current_;
	std::set<TileKey, TileKeyOrder> waiting_;
	std::set<TileKey, TileKeyOrder> refused_; ///< Tiles for which there was no room.
	std::set<TileKey, TileKeyOrder> divided_; ///< Visible tiles in cells.
};

} // namespace thicket
