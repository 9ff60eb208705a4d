#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/tile_builder.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

namespace thicket {

/// All steps of a tile on this thread, the main one. `ground` is what `terrain` gave for workers; where it is null, the terrain itself is
/// asked, there and then.
Status build_at_once(const LayerSettings &layer, const Terrain *ground, const ScatterTerrain &terrain, const Rect &rect,
		TileInstances &r_tile);

} // namespace thicket
