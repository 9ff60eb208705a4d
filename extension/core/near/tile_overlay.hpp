#pragma once

#include "core/base/tile_grid.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/state/instance_state.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_set>
#include <vector>

namespace thicket {

/// A game's changes, applied over generated tiles. Each member is null if there are no such
/// changes.
struct Overlay {
	const InstanceState *state = nullptr;
	/// IDs of instances that are displayed by other means. Null if there are none.
	const std::unordered_set<std::uint64_t> *hidden = nullptr;
};

using OverlaidMeshes = std::vector<std::shared_ptr<const CompactMesh>>;

/// Replaces `r_meshes` with the instances to draw for each mesh of a tile. The hand-placed
/// instances in the tile's `space` come first, sorted by ID. The generated ones follow in their
/// original order, bit-identical, except those that are removed or hidden. Hand-placed instances
/// have thinning rank 0, so only a density of 0 removes them. Their color inputs come from
/// fractions_by_hand(). A mesh without changes is shared with the tile, not copied. If memory runs
/// out, `r_meshes` is unchanged.
Status overlaid(const std::shared_ptr<const CompactTile> &tile, const LayerSettings &layer, const TileSpace &space,
		const Overlay &overlay, OverlaidMeshes &r_meshes);

} // namespace thicket
