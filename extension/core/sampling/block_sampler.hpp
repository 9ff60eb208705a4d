#pragma once

#include "core/sampling/resolver.hpp"

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
	const LevelGrid &finest() const { return levels_.front(); }
	const std::vector<LevelGrid> &levels() const { return levels_; }
	std::uint32_t retries() const { return retries_; }

private:
	std::vector<LevelGrid> levels_;
	std::uint32_t retries_ = 0;
};

} // namespace thicket
