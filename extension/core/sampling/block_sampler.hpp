#pragma once

#include "core/sampling/resolver.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Resolves blocks of cells of one point set, and widens the margin when a chain needs more.
class BlockSampler {
public:
	explicit BlockSampler(const SampleMargins &margins = {}) : margins_(margins) {}

	/// `rank` computes the rank that is stored with each point; see RankFunction.
	void prepare(const PointSet &set, RankFunction rank);

	/// Decides every cell of `block`. If the result is not ResolveResult::done, the contents of the grids are invalid.
	ResolveResult resolve(const CellRect &block, const std::atomic<bool> *cancel);

	/// The finest level. Valid for the cells of the last block.
	const LevelGrid &finest() const { return grids_.front(); }
	std::span<const LevelGrid> levels() const { return {grids_.data(), levels_}; }
	std::uint32_t retries() const { return retries_; }

	/// After ResolveResult::margin_too_small: the margin of the finest level in cells, and the center of the undecided cell in cells of
	/// the finest level.
	std::int32_t margin() const { return margin_; }
	glm::dvec2 undecided_cell() const;

private:
	SampleMargins margins_;
	std::int32_t margin_ = 0;
	std::vector<LevelGrid> grids_; ///< As many as the most levels of any set until now, to keep the memory.
	std::size_t levels_ = 0;
	std::uint32_t retries_ = 0;
};

} // namespace thicket
