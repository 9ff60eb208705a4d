#pragma once

#include "core/base/mutex.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/point_set.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// The points of an area of decided cells, in parts of 8 x 8 cells. The object does not change after
/// its construction.
class SettledArea {
public:
	static constexpr std::int32_t part_width = 8; ///< Width and height of a part in cells.

	struct Point {
		LevelGrid::PointOffset offset; ///< Offset of the point from the center of its cell.
		std::uint32_t rank;
	};

	/// Copies the points of `cells` from a grid in which they are decided. The coordinates of `cells`
	/// must be multiples of part_width. Throws std::bad_alloc.
	SettledArea(const LevelGrid &grid, const CellRect &cells);

	const CellRect &cells() const { return cells_; }

	/// Calls `visit(cell, point)` for each point of row `y` in the columns [first, end) of the part
	/// that begins at `corner`, in ascending order.
	template <class Visit>
	void for_each_in_row(
			glm::ivec2 corner, std::int32_t y, std::int32_t first, std::int32_t end, const Visit &visit) const {
		const Part &part = parts_[part_at(corner)];
		const std::int32_t shift = part_width * (y - corner.y);
		const std::uint64_t before = part.points & ((std::uint64_t{1} << shift) - 1);
		const Point *point = points_.data() + part.begin + std::popcount(before);
		for (auto rest = static_cast<std::uint32_t>(part.points >> shift & 0xff); rest != 0;
				rest &= rest - 1, ++point) {
			const std::int32_t x = corner.x + std::countr_zero(rest);
			if (first <= x && x < end) {
				visit(glm::ivec2(x, y), *point);
			}
		}
	}

	std::size_t bytes() const {
		return sizeof *this + parts_.capacity() * sizeof(Part) + points_.capacity() * sizeof(Point);
	}

private:
	struct Part {
		std::uint64_t points = 0; ///< One bit for each cell in row order, set if the cell has a point.
		std::uint32_t begin = 0;  ///< Index of the part's first point.
	};

	std::size_t part_at(glm::ivec2 corner) const {
		const glm::ivec2 at = (corner - cells_.min) / part_width;
		return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(cells_.size().x / part_width) +
				static_cast<std::size_t>(at.x);
	}

	CellRect cells_;
	std::vector<Part> parts_;
	std::vector<Point> points_;
};

/// Caches the points of recently sampled areas of any size, for windows that overlap. A layer that
/// fills gaps needs the points of earlier layers far beyond its tile, so the windows of adjacent
/// tiles share much of their area. Points depend on nothing but their set, so a cached area never
/// becomes outdated. Threads may share a cache.
class AreaCache {
public:
	/// Creates a cache of at most `bytes` bytes, which evicts the least recently used areas first.
	explicit AreaCache(std::size_t bytes) : limit_(bytes) {}

	/// Replaces `r_areas` with the cached areas of the set that overlap `window`.
	void find(const PointSet &set, const CellRect &window, std::vector<std::shared_ptr<const SettledArea>> &r_areas);
	void add(const PointSet &set, std::shared_ptr<const SettledArea> area);

	/// Returns the memory of all cached areas.
	std::size_t bytes() const;

private:
	struct Entry {
		PointSet set;
		std::shared_ptr<const SettledArea> area;
		std::uint64_t used; ///< Value of `clock_` at the latest request.
	};

	const std::size_t limit_;
	mutable Mutex mutex_;
	std::vector<Entry> entries_;
	std::size_t bytes_ = 0;
	std::uint64_t clock_ = 0;
};

/// The cached areas of a window of cells, which is expanded to whole parts. They stay in memory for
/// the lifetime of this object.
class AreaWindow {
public:
	/// Maximum width and height in cells. In larger windows, little area is shared with other windows.
	static constexpr std::int32_t widest = 1024;

	/// `window` must not be empty, and at most `widest` cells wide and high. Throws std::bad_alloc.
	AreaWindow(AreaCache &cache, const PointSet &set, const CellRect &window);

	/// Returns the window, expanded to whole parts.
	const CellRect &cells() const { return cells_; }

	/// Returns in `r_cells` an area that the caller must decide and pass to `settle`. Returns false if
	/// none is missing.
	bool next_missing(CellRect &r_cells);
	/// Stores the area that next_missing() returned last. `grid` must contain it with all cells
	/// decided. Throws std::bad_alloc.
	void settle(const LevelGrid &grid);

	/// Calls `visit(cell, point)` for each point of `block`, row by row. The block must be in the
	/// window, and no area may be missing.
	template <class Visit>
	void for_each(const CellRect &block, const Visit &visit) const {
		constexpr std::int32_t width = SettledArea::part_width;
		for (std::int32_t y = block.min.y; y < block.max.y; ++y) {
			const glm::ivec2 first = part_of({block.min.x, y});
			const std::int32_t end = part_of({block.max.x - 1, y}).x;
			for (glm::ivec2 part = first; part.x <= end; ++part.x) {
				const SettledArea &area = *areas_[owners_[index_of(part)]];
				area.for_each_in_row(cells_.min + part * width, y, block.min.x, block.max.x, visit);
			}
		}
	}

private:
	static constexpr std::uint16_t missing = 0xffff;

	glm::ivec2 part_of(glm::ivec2 cell) const { return (cell - cells_.min) / SettledArea::part_width; }
	std::size_t index_of(glm::ivec2 part) const {
		return static_cast<std::size_t>(part.y) * static_cast<std::size_t>(parts_.x) + static_cast<std::size_t>(part.x);
	}
	bool is_missing(glm::ivec2 first, std::int32_t end_x) const;
	void own(const CellRect &cells, std::uint16_t owner);

	AreaCache &cache_;
	PointSet set_;
	CellRect cells_;
	glm::ivec2 parts_;                  ///< Number of parts on each axis.
	std::vector<std::uint16_t> owners_; ///< For each part, the index of its area, or `missing`.
	std::vector<std::shared_ptr<const SettledArea>> areas_;
	CellRect next_; ///< The area that next_missing() returned last.
};

} // namespace thicket
