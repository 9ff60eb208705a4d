#pragma once

#include "core/base/mutex.hpp"
#include "core/sampling/area_cache.hpp"
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

/// All points of a block of decided cells, in row order. A cell is decided once the sampler knows
/// whether it has a point, and where. The object does not change after its construction.
class SettledBlock {
public:
	/// Maximum width and height in cells. The grid of a block of this size, including its margin,
	/// fits in the L2 cache.
	static constexpr std::int32_t width = 96;

	struct Point {
		LevelGrid::PointOffset offset; ///< Offset of the point from the center of its cell.
		std::uint32_t rank;
	};

	/// Copies the points of `cells` from a grid in which they are decided. `cells` must be at most
	/// `width` wide and high. Throws std::bad_alloc.
	SettledBlock(const LevelGrid &grid, const CellRect &cells);

	const CellRect &cells() const { return cells_; }
	/// Calls `visit(cell, point)` for each point of the columns [first, end) of row `y`, in
	/// ascending order.
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
		std::array<std::uint32_t, words> points{}; ///< One bit for each cell, set if the cell has a point.
		std::uint32_t begin = 0;                   ///< Index of the row's first point.
	};

	/// Returns a mask of the bits below `column`, which may lie outside the word.
	static constexpr std::uint32_t columns_before(std::int32_t column) {
		return column <= 0 ? 0 : column >= 32 ? ~0u : (1u << column) - 1;
	}

	CellRect cells_;
	std::array<Row, width> rows_{};
	std::vector<Point> points_;
};

/// Caches recently sampled blocks of point sets. Tiles that are small compared with a block then
/// share one margin, and the sampler decides layers that other layers read only once. The cache
/// saves work and never changes a point. Threads may share a cache.
///
/// The sampler computes a block for the second window that touches it. If an adjacent block is
/// present or being computed, the sampler computes the block for the first window, because the
/// requested area usually grows. A single isolated window costs the same as without a cache.
class BlockCache {
public:
	static constexpr std::size_t default_bytes = std::size_t{4} << 20;
	/// Returns the maximum width and height, in cells, of a window that uses the cache. The limit
	/// corresponds to a tile of 16 radii, or of 22 radii for sets with coarser levels, which need a
	/// wider margin. Larger windows have little margin to share, and blocks at the edge of the
	/// requested area would cost more than they save.
	static constexpr std::int32_t widest_window(std::uint32_t levels) { return levels > 1 ? 32 : 24; }

	/// Creates a cache of at most `bytes` bytes, which evicts the least recently used blocks first.
	explicit BlockCache(std::size_t bytes = default_bytes) : limit_(bytes), areas_(4 * bytes) {}

	/// Returns the memory of all cached blocks.
	std::size_t bytes() const;

	/// Returns the cache for larger windows that overlap. Its limit is four times that of the blocks,
	/// because it contains whole windows. It stays empty unless layers fill gaps.
	AreaCache &areas() { return areas_; }

private:
	friend class SettledWindow;

	struct Key {
		PointSet set;
		glm::ivec2 block{0};
		bool operator<(const Key &other) const;
	};
	struct Entry {
		std::shared_ptr<const SettledBlock> block;
		bool in_work = false;   ///< True while a caller is computing the block.
		std::uint64_t used = 0; ///< Value of `clock_` at the latest request.
	};

	bool is_made_beside(const Key &key) const;
	void trim();

	const std::size_t limit_;
	AreaCache areas_;
	mutable Mutex mutex_;
	/// Cached blocks, and entries without a block for blocks that were requested only once.
	std::map<Key, Entry> entries_;
	std::size_t bytes_ = 0;
	std::uint64_t clock_ = 0;
};

/// The cached blocks that overlap a window of cells. They stay in memory for the lifetime of this
/// object.
class SettledWindow {
public:
	/// Requests the blocks of `window`, which must not be empty, and at most SettledBlock::width
	/// wide and high. Throws std::bad_alloc.
	SettledWindow(BlockCache &cache, const PointSet &set, const CellRect &window);
	/// Releases blocks that this object claimed but did not compute, so that other windows can
	/// compute them.
	~SettledWindow();
	SettledWindow(const SettledWindow &) = delete;
	SettledWindow &operator=(const SettledWindow &) = delete;

	/// Returns true if the caller should take the points from blocks. The result is false if
	/// another caller is computing one of the blocks. It is also false if this window is the
	/// first to touch a block, and no block next to it is present or being computed.
	bool served() const { return served_; }

	/// Returns in `r_cells` the next block that the caller must compute and pass to `settle`,
	/// clipped to the cells of the set. Returns false if all blocks are present.
	bool next_missing(CellRect &r_cells);
	/// Stores the block that next_missing() returned last. `grid` must contain it with all cells
	/// decided. Throws std::bad_alloc.
	void settle(const LevelGrid &grid);

	/// Calls `visit(cell, point)` for each point of the window, row by row. All blocks must be
	/// present.
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
		bool claimed = false; ///< True if the caller must compute the block.
	};

	BlockCache &cache_;
	CellRect window_;
	std::array<Slot, 4> slots_; ///< The blocks in row order, so that a row's points are visited in order.
	std::size_t count_ = 0;
	std::size_t missing_ = 0; ///< Index of the slot that `settle` fills.
	bool served_ = false;
};

} // namespace thicket
