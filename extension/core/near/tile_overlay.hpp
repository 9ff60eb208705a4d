#pragma once

#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/state/instance_state.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_set>
#include <vector>

namespace thicket {

/// A game's changes, applied over generated tiles. Null if there are none.
struct Overlay {
	const InstanceState *state = nullptr;
	const std::unordered_set<std::uint64_t> *hidden = nullptr; ///< Ids of instances that are displayed by other means.
};

using OverlaidMeshes = std::vector<std::shared_ptr<const CompactMesh>>;

/// Replaces `r_meshes` by the instances that are drawn for each mesh of a tile. The first ones were placed by hand in
/// the half-open `rect` of the tile, sorted by id. The generated ones follow, in the same order and with the same bits,
/// without those that are removed or hidden. Hand-placed instances have thinning rank 0, so no density above 0 removes
/// them. For the inputs of their color, see share_by_hand. A mesh without changes is shared with the tile, not copied.
/// If memory runs out, `r_meshes` is unchanged.
Status overlaid(const std::shared_ptr<const CompactTile> &tile, const LayerSettings &layer, const Rect &rect,
		const Overlay &overlay, OverlaidMeshes &r_meshes);

} // namespace thicket
