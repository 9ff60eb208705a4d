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
	/// Cells along each side. The grid of a block of this width, with its margin, stays in the second-level cache.
	static constexpr std::int32_t width = 96;

	struct Point {
		LevelGrid::PointOffset offset; ///< In its cell.
		std::uint32_t rank;
	};

	/// Of a grid in which `cells`, at most `width` wide and high, are decided. Throws std::bad_alloc.
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
		std::array<std::uint32_t, words> points{}; ///< A bit for each cell: whether it has one.
		std::uint32_t begin = 0;                   ///< Of its points.
	};

	/// Bits of the columns of a word before one that may lie beyond it.
	static constexpr std::uint32_t columns_before(std::int32_t column) {
		return column <= 0 ? 0 : column >= 32 ? ~0u : (1u << column) - 1;
	}

	CellRect cells_;
	std::array<Row, width> rows_{};
	std::vector<Point> points_;
};

/// Keeps blocks of sets that were sampled lately, so that tiles which are small beside a block, and layers at which other layers look,
/// are decided once and share one margin. It saves work and changes no point. Safe for any number of threads.
///
/// A block is made for the second window that touches it, or for the first one where a block beside it is there: what is wanted grows.
/// A single window somewhere costs what it did without a cache.
class BlockCache {
public:
	static constexpr std::size_t default_bytes = std::size_t{4} << 20;
	/// Cells along the longer side of the largest window that is served: tiles of 16 r, of 22 r where a set has coarser levels, whose
	/// margin is wider. Larger ones have little margin to share, and a block at the edge of what is wanted costs more than it saves.
	static constexpr std::int32_t widest_window(std::uint32_t levels) { return levels > 1 ? 32 : 24; }

	/// Keeps at most `bytes` of blocks, the last used ones.
	explicit BlockCache(std::size_t bytes = default_bytes) : limit_(bytes) {}

	/// Bytes of the blocks that it holds.
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
		bool in_work = false;   ///< Somebody makes it.
		std::uint64_t used = 0; ///< When it was asked for last.
	};

	bool is_made_beside(const Key &key) const;
	void trim();

	const std::size_t limit_;
	mutable Mutex mutex_;
	std::map<Key, Entry> entries_; ///< Without a block, too: of what was asked for once.
	std::size_t bytes_ = 0;
	std::uint64_t clock_ = 0;
};

/// The blocks of a cache around a window of cells, for as long as the object lives.
class SettledWindow {
public:
	/// Asks for the blocks of a window that is not empty and not wider than SettledBlock::width. Throws std::bad_alloc.
	SettledWindow(BlockCache &cache, const PointSet &set, const CellRect &window);
	/// Leaves to others what was to be made and was not.
	~SettledWindow();
	SettledWindow(const SettledWindow &) = delete;
	SettledWindow &operator=(const SettledWindow &) = delete;

	/// Whether the window is to be taken from blocks. If not, it was the first to touch one of them and those beside it, or somebody else
	/// is at work on one.
	bool served() const { return served_; }

	/// The next block that the caller has to make for `settle`, clear of the set's last cell; false if all are there.
	bool next_missing(CellRect &r_cells);
	/// Takes over the block that was asked for last, from a grid in which it is decided. Throws std::bad_alloc.
	void settle(const LevelGrid &grid);

	/// Calls `visit(cell, point)` for the points of the window, row by row. All blocks have to be there.
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
		bool claimed = false; ///< Ours to make.
	};

	BlockCache &cache_;
	CellRect window_;
	std::array<Slot, 4> slots_; ///< By rows, so that those of one row stand in order.
	std::size_t count_ = 0;
	std::size_t missing_ = 0; ///< The slot that `settle` is for.
	bool served_ = false;
};

} // namespace thicket
