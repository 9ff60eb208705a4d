#include "core/query/tile_content.hpp"

#include <algorithm>

namespace thicket {

PlacedInstance placed_instance(
		std::uint64_t id, std::uint32_t layer, std::uint32_t mesh, glm::dvec3 origin, const float *transform) {
	PlacedInstance placed{.id = id, .layer = layer, .mesh = mesh, .position = position_of(origin, transform)};
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			placed.basis[column][row] = transform[row * 4 + column];
		}
	}
	return placed;
}

PlacedInstance placed_instance(std::uint64_t id, std::uint32_t layer, const AddedInstance &added) {
	return {.id = id, .layer = layer, .mesh = added.mesh, .position = added.position, .basis = added.basis};
}

void sort_by_id(std::vector<InstanceRef> &r_refs) {
	std::sort(r_refs.begin(), r_refs.end(), [](const InstanceRef &a, const InstanceRef &b) { return a.id < b.id; });
}

} // namespace thicket
