#pragma once

#include "core/base/tile_grid.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Reorders the waiting entries of a queue after viewers have moved. `r_order[i]` becomes the index
/// in `areas` of the entry for position i. Each viewer's entries are those that are nearest to it.
/// They are sorted by distance, but only among the positions that they already occupy. Many entries
/// around one viewer therefore do not delay the entries of another viewer. Without viewers, the
/// order is unchanged.
void work_order(std::span<const TileSpace> areas, std::span<const Viewer> viewers, std::vector<std::size_t> &r_order);

} // namespace thicket
