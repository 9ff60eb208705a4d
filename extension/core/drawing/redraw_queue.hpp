#pragma once

#include "core/base/rect.hpp"
#include "core/drawing/tile_key_order.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace thicket {

/// Decides which visible tiles are redrawn after a game's changes: some before the next frame, others one after another when there is
/// time. Pure logic, like TileStreamer.
///
/// Promises:
///  (1) Each mark counts for one `take`, and for all tiles that it meets, whether they are visible before or after it.
///  (2) An upload that began before a change has an older `version` than one that began after it.
///  (3) A tile that is queued for later is returned once, however often it was queued, and in TileKeyOrder.
class RedrawQueue {
public:
	/// The areas that were marked until a `take`.
	class Marks {
	public:
		bool empty() const { return areas_.empty() && !all_; }

		/// True if a tile with this rectangle must be redrawn.
		bool meet(std::uint32_t layer, const Rect &rect) const;

	private:
		friend class RedrawQueue;
		struct Area {
			std::uint32_t layer = 0;
			Rect rect;
		};
		std::vector<Area> areas_;
		std::map<std::uint32_t, Rect> bounds_; ///< Around all areas of each layer.
		bool all_ = false;
	};

	/// Reports that instances may have changed in an area of a layer (world meters, edges included), or everywhere.
	void mark(std::uint32_t layer, const Rect &area) { marks_.areas_.push_back({layer, area}); }
	void mark_all() { marks_.all_ = true; }

	/// Allocates memory, so that the next `mark` throws nothing.
	void reserve_mark() { marks_.areas_.reserve(marks_.areas_.size() + 1); }

	/// Returns all marks and forgets them. If memory runs out, throws and keeps them.
	Marks take();

	/// Reports that instances have changed. The caller then queues each visible tile that may be affected.
	void begin_later() { ++version_; }
	void add_later(const TileKey &key) { later_.insert(key); }
	bool has_later() const { return !later_.empty(); }

	/// Removes the first tile that is queued for later and returns it. The tile may be hidden by now.
	std::optional<TileKey> next_later();

	/// Rises with every change: with `begin_later`, and with every `take` that returns marks.
	std::uint64_t version() const { return version_; }

	/// Forgets all marks and tiles.
	void clear();

private:
	Marks marks_;
	std::set<TileKey, TileKeyOrder> later_;
	std::uint64_t version_ = 0;
};

} // namespace thicket
