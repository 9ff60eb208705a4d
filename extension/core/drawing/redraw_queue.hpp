#pragma once

#include "core/base/rect.hpp"
#include "core/drawing/tile_key_order.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace thicket {

/// Decides which visible tiles are redrawn after a game's changes. Marked areas are redrawn before
/// the next frame. Tiles queued for later are redrawn one by one as time permits. The class only
/// makes decisions, like TileStreamer.
///
/// Guarantees:
///  (1) Each mark applies to exactly one `take` and to all tiles that it touches, even if they
///      became visible after it.
///  (2) An upload that began before a change has a lower `version` than one that began after it.
///  (3) Tiles queued for later are returned in TileKeyOrder, each once, even if they were queued
///      several times.
class RedrawQueue {
public:
	/// The areas returned by `take`.
	class Marks {
	public:
		bool empty() const { return areas_.empty() && !is_everything_; }

		/// Returns true if a tile with this rectangle must be redrawn.
		bool meet(std::uint32_t layer, const Rect &rect) const;

	private:
		friend class RedrawQueue;
		struct Area {
			std::uint32_t layer = 0;
			Rect rect;
		};
		std::vector<Area> areas_;
		std::map<std::uint32_t, Rect> bounds_; ///< Bounds of all areas, by layer.
		bool is_everything_ = false;
	};

	/// Reports that instances may have changed in an area of a layer (world meters, edges
	/// included), or everywhere.
	void mark(std::uint32_t layer, const Rect &area) { marks_.areas_.push_back({layer, area}); }
	void mark_all() { marks_.is_everything_ = true; }

	/// Allocates memory, so that the next `mark` does not throw.
	void reserve_mark() { marks_.areas_.reserve(marks_.areas_.size() + 1); }

	/// Returns and clears all marks. If memory runs out, throws std::bad_alloc and keeps them.
	Marks take();

	/// Reports that instances have changed. The caller then calls `add_later` for each visible tile
	/// that may be affected.
	void begin_later() { ++version_; }
	void add_later(const TileKey &key) { queued_tiles_.insert(key); }
	bool has_queued() const { return !queued_tiles_.empty(); }

	/// Removes and returns the first tile that is queued for later. This tile may no longer be
	/// visible.
	std::optional<TileKey> next_queued();

	/// Returns the number of the last change. It increases in `begin_later` and in every `take`
	/// that returns marks.
	std::uint64_t version() const { return version_; }

	/// Removes all marks and tiles.
	void clear();

private:
	Marks marks_;
	std::set<TileKey, TileKeyOrder> queued_tiles_;
	std::uint64_t version_ = 0;
};

} // namespace thicket
