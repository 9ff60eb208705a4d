#include "core/sampling/block_sampler.hpp"

#include <algorithm>

namespace thicket {

void BlockSampler::prepare(const PointSet &set, RankFunction rank) {
	levels_ = set.levels;
	if (grids_.size() < levels_) {
		grids_.resize(levels_);
	}
	for (std::uint32_t level = 0; level < set.levels; ++level) {
		LevelGrid &grid = grids_[level];
		grid.source = DartSource::of(set, level);
		grid.level = level;
		grid.levels = set.levels;
		grid.rank = rank;
		grid.coarser = level + 1 < set.levels ? &grids_[level + 1] : nullptr;
	}
}

ResolveResult BlockSampler::resolve(const CellRect &block, const std::atomic<bool> *cancel) {
	margin_ = margins_.first;
	for (retries_ = 0;; ++retries_) {
		const std::span<LevelGrid> levels(grids_.data(), levels_);
		CellRect needed = block;
		for (LevelGrid &grid : levels) {
			// Chains of darts in the finest level's margin also need the coarser levels, so the
			// margin of the coarser levels is wider.
			grid.reset(needed.grown(grid.level == 0 ? margin_ : margin_ + margin_ / 8));
			needed = coarse_cells_around(needed);
		}
		const ResolveResult result = resolve_block(levels, block, cancel);
		if (result != ResolveResult::margin_too_small || margin_ >= margins_.widest) {
			return result;
		}
		margin_ = std::min(std::max(2 * margin_, 1), margins_.widest);
	}
}

glm::dvec2 BlockSampler::undecided_cell() const {
	for (const LevelGrid &grid : levels()) {
		if (grid.undecided != LevelGrid::nowhere) {
			const glm::dvec2 cell(grid.cell_of(grid.undecided));
			return (cell + 0.5) * static_cast<double>(1u << grid.level);
		}
	}
	return {};
}

} // namespace thicket
