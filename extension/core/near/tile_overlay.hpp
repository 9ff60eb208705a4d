#pragma once

#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/kept_tile.hpp"
#include "core/state/instance_state.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_set>
#include <vector>

namespace thicket {

/// What lies over the tiles that a layer's rules give. Null for nothing.
struct Overlay {
	const InstanceState *state = nullptr;
	const std::unordered_set<std::uint64_t> *hidden = nullptr; ///< Ids that stand, but are shown by other means.
};

using OverlaidMeshes = std::vector<std::shared_ptr<const KeptMesh>>;

/// Replaces `r_meshes` by what is drawn of each mesh of a tile: what was placed by hand in the half-open `rect` of the tile, by id, then what its rules give,
/// in the same order and with the same bits, without what is removed or hidden. Hand-placed instances have thinning rank 0: no
/// density above 0 takes them away; of what their color follows, see share_by_hand. A mesh to which nothing applies is the tile's own; no copy is made of it.
/// Where memory does not suffice, `r_meshes` stays as it was.
Status overlaid(const std::shared_ptr<const KeptTile> &tile, const LayerSettings &layer, const Rect &rect,
		const Overlay &overlay, OverlaidMeshes &r_meshes);

} // namespace thicket
