#pragma once

#include "core/sampling/level_grid.hpp"

#include <atomic>
#include <cstdint>
#include <span>

namespace thicket {

enum class ResolveResult : std::uint8_t {
	done,
	margin_too_small, ///< A chain needs a cell outside a grid. The contents of the grids are invalid.
	cancelled,
};

/// Decides every cell of `block` (cells of levels[0]) on grids that were reset around it. levels[0] is the finest, and each level's
/// `coarser` is the next. Uses the best instruction set of this machine. All instruction sets return the same bits.
ResolveResult resolve_block(std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel);

} // namespace thicket
