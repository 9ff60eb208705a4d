#pragma once

#include "core/sampling/level_grid.hpp"

#include <atomic>
#include <cstdint>
#include <span>

namespace thicket {

enum class ResolveResult : std::uint8_t {
	done,
	margin_too_small, ///< A chain of darts needs a cell outside a grid. The contents of the grids are invalid.
	cancelled,
};

/// Decides all cells of `block`, in cells of levels[0]. The grids must have been reset for an area
/// around it. levels[0] is the finest level, and the `coarser` of each level points to the next
/// one. `cancel` may be null. The function uses the best instruction set of the machine; all
/// instruction sets return the same bits.
ResolveResult resolve_block(std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel);

} // namespace thicket
