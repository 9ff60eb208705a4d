#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "nodes/scatter/tile_workers.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

namespace thicket {

/// All steps of a tile on this thread, the main one; a terrain that may only be asked there is asked there and then.
Status build_at_once(const LayerPlan &plan, const HostedTerrain &terrain, const Rect &rect, TileInstances &r_tile);

} // namespace thicket
