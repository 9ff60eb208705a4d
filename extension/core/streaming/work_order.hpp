#pragma once

#include "core/base/rect.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// The order in which to work on what waits in a queue, after viewers have moved: `r_order[i]` says which of `areas` comes at
/// index i. Those that are nearest to the same viewer are sorted by their distance to it, among the indices that they
/// had: however many there are around one viewer, those of another do not fall back. Without viewers all stay.
void work_order(std::span<const Rect> areas, std::span<const Viewer> viewers, std::vector<std::size_t> &r_order);

} // namespace thicket
