#include "core/sampling/block_sampler.hpp"

namespace thicket {

namespace {

/// Cells around a block that nearly every chain stays in: tests/bench counts how often it does not. The coarser levels serve
/// the chains in the finest level's margin too.
constexpr std::int32_t finest_margin = 16;
constexpr std::int32_t coarser_margin = 18;

} // namespace

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

bool BlockSampler::resolve(const CellRect &block, const std::atomic<bool> *cancel) {
	for (retries_ = 0;; ++retries_) {
		const std::span<LevelGrid> levels(grids_.data(), levels_);
		CellRect needed = block;
		for (LevelGrid &grid : levels) {
			const std::int32_t margin = grid.level == 0 ? finest_margin : coarser_margin;
			grid.reset(needed.grown(margin << retries_));
			needed = coarse_cells_around(needed);
		}
		const ResolveResult result = resolve_block(levels, block, cancel);
		if (result != ResolveResult::margin_too_small) {
			return result == ResolveResult::done;
		}
	}
}

} // namespace thicket
