#pragma once

#include "core/base/guard.hpp"
#include "core/query/instance_query.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Returns the position of an instance in world meters. `origin` is the tile's origin.
inline glm::dvec3 position_of(glm::dvec3 origin, glm::vec3 in_tile) { return origin + glm::dvec3(in_tile); }

/// Assembles the instance at index `at` of a tile's mesh.
PlacedInstance placed_instance(
		std::uint32_t layer, std::uint32_t mesh, glm::dvec3 origin, const CompactMesh &content, std::size_t at);

/// Assembles a hand-placed instance.
PlacedInstance placed_instance(std::uint64_t id, std::uint32_t layer, const AddedInstance &added);

/// Looks up whether the state has removed a point of a layer. The constructor checks once whether
/// the layer has removed points, so that `contains` is fast if there are none.
class RemovedPoints {
public:
	RemovedPoints(const InstanceState *state, std::uint16_t layer) : state_(state) {
		if (state != nullptr && !state->any_removed(layer)) {
			// No point of the layer is removed, so no lookup is needed.
			state_ = nullptr;
		}
	}

	bool contains(std::uint64_t id) const { return state_ != nullptr && state_->removed(id); }

private:
	const InstanceState *state_;
};

/// Calls `visit(id, added)` for each hand-placed instance of a layer in a half-open rectangle, in
/// ascending order of IDs. Instances that an earlier call to `visit` has removed from the state are
/// skipped.
template <class Visit>
void for_hand_placed(const InstanceQuery &query, std::uint32_t layer, const Rect &rect, const Visit &visit) {
	if (query.state == nullptr) {
		return;
	}
	std::vector<std::uint64_t> ids;
	throw_if_out_of_memory(query.state->added_in(query.layers[layer].set.layer, rect, ids));
	for (const std::uint64_t id : ids) {
		if (const AddedInstance *added = query.state->added(id); added != nullptr) {
			visit(id, *added);
		}
	}
}

} // namespace thicket
