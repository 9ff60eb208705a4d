#pragma once

#include "core/sampling/resolver.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Resolves blocks of cells of one point set, widening the margin where a chain asks for more.
class BlockSampler {
public:
	/// `rank` gives the value that stands with each point; see RankFunction.
	void prepare(const PointSet &set, RankFunction rank);

	/// Decides every cell of `block`. False when cancelled.
	bool resolve(const CellRect &block, const std::atomic<bool> *cancel);

	/// The finest level, valid for the cells of the last block.
	const LevelGrid &finest() const { return grids_.front(); }
	std::span<const LevelGrid> levels() const { return {grids_.data(), levels_}; }
	std::uint32_t retries() const { return retries_; }

private:
	std::vector<LevelGrid> grids_; ///< As many as any set so far had levels: memory is kept.
	std::size_t levels_ = 0;
	std::uint32_t retries_ = 0;
};

} // namespace thicket
