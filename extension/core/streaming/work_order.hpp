#pragma once

#include "core/base/rect.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Computes the order for the waiting entries of a queue after viewers have moved: `r_order[i]` is the entry of `areas`
/// for index i. Entries that are nearest to the same viewer are sorted by distance to it, and share the indices that
/// these entries had before. So many entries around one viewer do not push back those of other viewers. Without
/// viewers, the order is unchanged.
void work_order(std::span<const Rect> areas, std::span<const Viewer> viewers, std::vector<std::size_t> &r_order);

} // namespace thicket
