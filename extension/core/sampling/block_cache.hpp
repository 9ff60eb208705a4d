#pragma once

#include "core/base/mutex.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/point_set.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace thicket {

/// All points of a block of cells, by rows.
class SettledBlock {
public:
	/// Cells along each side. The grid of a block of this width, including its margin, fits in the second-level cache.
	static constexpr std::int32_t width = 96;

	struct Point {
		LevelGrid::PointOffset offset; ///< Relative to its cell.
		std::uint32_t rank;
	};

	/// Takes the points from a grid in which `cells`, at most `width` wide and high, are decided. Throws std::bad_alloc.
	SettledBlock(const LevelGrid &grid, const CellRect &cells);

	const CellRect &cells() const { return cells_; }
	/// Calls `visit(cell, point)` for the points of the cells from `first` to `end` in the row `y`, in order.
	template <class Visit>
	void for_each_in_row(std::int32_t y, std::int32_t first, std::int32_t end, const Visit &visit) const {
		const Row &row = rows_[static_cast<std::size_t>(y - cells_.min.y)];
		const Point *point = points_.data() + row.begin;
		for (std::uint32_t word = 0; word < words; ++word) {
			const std::int32_t corner = cells_.min.x + static_cast<std::int32_t>(word) * 32;
			const std::uint32_t before = row.points[word] & columns_before(first - corner);
			point += std::popcount(before);
			for (std::uint32_t rest = row.points[word] & columns_before(end - corner) & ~before; rest != 0;
					rest &= rest - 1) {
				visit(glm::ivec2(corner + std::countr_zero(rest), y), *point++);
			}
		}
	}

	std::size_t bytes() const { return sizeof *this + points_.capacity() * sizeof(Point); }

private:
	static constexpr std::uint32_t words = width / 32;
	static_assert(width % 32 == 0);

	struct Row {
		std::array<std::uint32_t, words> points{}; ///< A bit for each cell, set if it has a point.
		std::uint32_t begin = 0;                   ///< Index of the row's first point.
	};

	/// A mask of the bits before a column of a word. The column may lie outside the word.
	static constexpr std::uint32_t columns_before(std::int32_t column) {
		return column <= 0 ? 0 : column >= 32 ? ~0u : (1u << column) - 1;
	}

	CellRect cells_;
	std::array<Row, width> rows_{};
	std::vector<Point> points_;
};

/// Keeps recently sampled blocks of point sets. So tiles that are small compared with a block share one margin, and
/// layers that other layers read are decided only once. The cache saves work and changes no point. Safe for any number
/// of threads.
///
/// A block is computed for the second window that touches it, or for the first one if an adjacent block is present, because the requested
/// area usually grows. A single isolated window costs the same as without a cache.
class BlockCache {
public:
	static constexpr std::size_t default_bytes = std::size_t{4} << 20;
	/// Cells along the longer side of the largest window that uses the cache: tiles of 16 r, or of 22 r where a set has coarser levels,
	/// whose margin is wider. Larger windows have little margin to share, and a block at the edge of the requested area costs more than
	/// it saves.
	static constexpr std::int32_t widest_window(std::uint32_t levels) { return levels > 1 ? 32 : 24; }

	/// Keeps at most `bytes` of blocks, the most recently used ones.
	explicit BlockCache(std::size_t bytes = default_bytes) : limit_(bytes) {}

	/// Bytes of the blocks that the cache holds.
	std::size_t bytes() const;

private:
	friend class SettledWindow;

	struct Key {
		PointSet set;
		glm::ivec2 block{0};
		bool operator<(const Key &other) const;
	};
	struct Entry {
		std::shared_ptr<const SettledBlock> block;
		bool in_work = false;   ///< A caller is computing the block.
		std::uint64_t used = 0; ///< Clock value of the latest request.
	};

	bool is_made_beside(const Key &key) const;
	void trim();

	const std::size_t limit_;
	mutable Mutex mutex_;
	std::map<Key, Entry> entries_; ///< Includes entries without a block: blocks requested once.
	std::size_t bytes_ = 0;
	std::uint64_t clock_ = 0;
};

/// The blocks of a cache around a window of cells, held for the lifetime of the object.
class SettledWindow {
public:
	/// Requests the blocks of a window that is not empty and not wider than SettledBlock::width. Throws std::bad_alloc.
	SettledWindow(BlockCache &cache, const PointSet &set, const CellRect &window);
	/// Releases the claimed blocks that were not computed, so that others can compute them.
	~SettledWindow();
	SettledWindow(const SettledWindow &) = delete;
	SettledWindow &operator=(const SettledWindow &) = delete;

	/// Whether the caller should take the window from blocks. False if this window was the first to touch one of them and the adjacent
	/// blocks, or if another caller is computing one.
	bool served() const { return served_; }

	/// Returns the next block that the caller must compute for `settle`, clear of the set's last cell. False if all blocks are present.
	bool next_missing(CellRect &r_cells);
	/// Stores the block that next_missing() returned last, from a grid in which it is decided. Throws std::bad_alloc.
	void settle(const LevelGrid &grid);

	/// Calls `visit(cell, point)` for the points of the window, row by row. All blocks must be present.
	template <class Visit>
	void for_each(const Visit &visit) const {
		for (std::int32_t y = window_.min.y; y < window_.max.y; ++y) {
			for (std::size_t slot = 0; slot < count_; ++slot) {
				const SettledBlock &block = *slots_[slot].block;
				if (y < block.cells().min.y || y >= block.cells().max.y) {
					continue;
				}
				block.for_each_in_row(y, window_.min.x, window_.max.x, visit);
			}
		}
	}

private:
	struct Slot {
		BlockCache::Key key;
		std::shared_ptr<const SettledBlock> block;
		bool claimed = false; ///< This object must compute it.
	};

	BlockCache &cache_;
	CellRect window_;
	std::array<Slot, 4> slots_; ///< By rows, so that the blocks of one row are in order.
	std::size_t count_ = 0;
	std::size_t missing_ = 0; ///< The slot that `settle` fills.
	bool served_ = false;
};

} // namespace thicket
