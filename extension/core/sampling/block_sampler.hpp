#pragma once

#include "core/sampling/obstacle_grid.hpp"
#include "core/sampling/obstacles.hpp"
#include "core/sampling/resolver.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Decides the cells of blocks of one point set. When a chain of dependent darts leaves the margin
/// around a block, it retries with a wider margin.
class BlockSampler {
public:
	explicit BlockSampler(const SampleMargins &margins = {}) : margins_(margins) {}

	/// Selects the point set. `rank` computes the rank that is stored with each point.
	void prepare(const PointSet &set, RankFunction rank);

	/// Decides all cells of `block`. If the result is not ResolveResult::done, the contents of the
	/// grids are invalid. `cancel` and `obstacles` may be null. With obstacles, the margin is
	/// determined by them and is never widened. Throws std::bad_alloc.
	ResolveResult resolve(const CellRect &block, const std::atomic<bool> *cancel, const Obstacles *obstacles = nullptr);

	/// Returns the grid of the finest level. Only the cells of the last block are valid.
	const LevelGrid &finest() const { return grids_.front(); }
	/// Replaces the rank of the point in a cell of the finest level.
	void set_rank(glm::ivec2 cell, std::uint32_t rank) { grids_.front().dart[grids_.front().index_of(cell)] = rank; }
	std::span<const LevelGrid> levels() const { return {grids_.data(), levels_}; }
	std::uint32_t retries() const { return retries_; }
	std::size_t obstacle_bytes() const { return obstacle_grid_.bytes(); }

	/// Valid after ResolveResult::margin_too_small: the margin of the finest level in cells, and
	/// the center of the undecided cell in units of finest cells.
	std::int32_t margin() const { return margin_; }
	glm::dvec2 undecided_cell() const;

private:
	/// Width of the margin that EvenOrder needs, so that coarser levels are decided far enough.
	static constexpr std::int32_t even_margin = 4;

	SampleMargins margins_;
	std::int32_t least_margin_ = 0;
	std::int32_t margin_ = 0;
	/// One grid per level. The list may have more grids than the current set has levels, to reuse
	/// memory.
	std::vector<LevelGrid> grids_;
	std::size_t levels_ = 0;
	double unit_ = 1.0; ///< The lattice unit of the finest level in meters.
	ObstacleGrid obstacle_grid_;
	std::uint32_t retries_ = 0;
};

} // namespace thicket
