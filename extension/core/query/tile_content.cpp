#include "core/query/tile_content.hpp"

#include <array>

namespace thicket {

PlacedInstance placed_instance(
		std::uint32_t layer, std::uint32_t mesh, glm::dvec3 origin, const CompactMesh &content, std::size_t at) {
	PlacedInstance placed{.id = content.id(at),
			.layer = layer,
			.mesh = mesh,
			.position = position_of(origin, content.positions()[at])};
	std::array<float, transform_floats> transform;
	content.read_transform(at, transform);
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			placed.basis[column][row] = transform[static_cast<std::size_t>(row * 4 + column)];
		}
	}
	return placed;
}

PlacedInstance placed_instance(std::uint64_t id, std::uint32_t layer, const AddedInstance &added) {
	return {.id = id, .layer = layer, .mesh = added.mesh, .position = added.position, .basis = added.basis};
}

} // namespace thicket
