#include "core/sampling/block_sampler.hpp"

#include <algorithm>

namespace thicket {

void BlockSampler::prepare(const PointSet &set, RankFunction rank) {
	levels_ = set.levels;
	least_margin_ = set.even_order ? even_margin : 0;
	unit_ = lattice_unit(set);
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

ResolveResult BlockSampler::resolve(
		const CellRect &block, const std::atomic<bool> *cancel, const Obstacles *obstacles) {
	margin_ = obstacles != nullptr ? obstacles->margin : std::max(margins_.first, least_margin_);
	const std::int32_t widest = obstacles != nullptr ? obstacles->margin : margins_.widest;
	for (retries_ = 0;; ++retries_) {
		const std::span<LevelGrid> levels(grids_.data(), levels_);
		CellRect needed = block;
		for (LevelGrid &grid : levels) {
			// Chains of darts in the finest level's margin also need the coarser levels, so the
			// margin of the coarser levels is wider.
			grid.reset(needed.grown(grid.level == 0 ? margin_ : margin_ + margin_ / 8));
			needed = coarse_cells_around(needed);
		}
		LevelGrid &finest = levels.front();
		if (obstacles != nullptr) {
			obstacle_grid_.set(finest, unit_, obstacles->disks);
		}
		finest.obstacles = obstacles != nullptr ? &obstacle_grid_ : nullptr;
		const ResolveResult result = resolve_block(levels, block, cancel);
		if (result != ResolveResult::margin_too_small || margin_ >= widest) {
			return result;
		}
		margin_ = std::min(std::max(2 * margin_, 1), widest);
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
