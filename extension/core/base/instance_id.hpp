#pragma once

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// Cells lie in [-cell_limit, cell_limit) on both axes of a layer's base square lattice.
inline constexpr std::int32_t cell_limit = 1 << 23;

/// The first of the bits that contain the layer of an id. The bits below identify an instance within its layer.
inline constexpr int id_layer_shift = 48;
inline constexpr std::uint64_t id_cell_mask = (std::uint64_t{1} << id_layer_shift) - 1;

/// The layer and the base square of a point. A base square contains at most one point of a set, so the id identifies
/// the point permanently, whatever is loaded: 16 bits for the layer, 24 for the cell's x, 24 for its y.
struct InstanceId {
	std::uint16_t layer = 0;
	glm::ivec2 cell{0}; ///< In [-cell_limit, cell_limit); other values do not survive `pack`.

	friend bool operator==(const InstanceId &, const InstanceId &) = default;
};

constexpr std::uint64_t pack(const InstanceId &id) {
	const auto x = static_cast<std::uint32_t>(id.cell.x + cell_limit);
	const auto y = static_cast<std::uint32_t>(id.cell.y + cell_limit);
	return std::uint64_t{id.layer} << id_layer_shift | std::uint64_t{x} << 24 | std::uint64_t{y};
}

constexpr InstanceId unpack(std::uint64_t packed) {
	const auto cell_of = [](std::uint64_t bits) {
		return static_cast<std::int32_t>(bits & 0xffffff) - cell_limit;
	};
	return {static_cast<std::uint16_t>(packed >> id_layer_shift), {cell_of(packed >> 24), cell_of(packed)}};
}

} // namespace thicket
