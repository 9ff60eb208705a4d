#pragma once

#include <glm/vec2.hpp>

#include <cstdint>

namespace thicket {

/// The cell of a base square is its integer coordinates in the layer's grid. Both are in
/// [-cell_limit, cell_limit). See `InstanceId`.
inline constexpr std::int32_t cell_limit = 1 << 23;

/// Number of the lowest bit of the layer in an ID. The bits below it identify an instance within
/// its layer.
inline constexpr int id_layer_shift = 48;
inline constexpr std::uint64_t id_cell_mask = (std::uint64_t{1} << id_layer_shift) - 1;

/// The ID of a point on a surface (see core/surface) encodes a cell in space. The cell's x and z
/// are in [-surface_id_extent, surface_id_extent), and its y is in [-surface_id_height,
/// surface_id_height). Each of the two components of the packed cell contains surface_id_step_bits
/// bits of y.
inline constexpr int surface_id_step_bits = 7;
inline constexpr std::int32_t surface_id_steps = 1 << surface_id_step_bits;
inline constexpr std::int32_t surface_id_extent = cell_limit / surface_id_steps;
inline constexpr std::int32_t surface_id_height = surface_id_steps * surface_id_steps / 2;

/// Identifies a point by its layer and its base square. Base squares have a diagonal of one radius
/// and cover the plane as a grid. A base square contains at most one point of a set, so the ID
/// identifies the point permanently, regardless of the loaded tiles. A packed ID has 16 bits for
/// the layer, 24 for the cell's x and 24 for its y.
struct InstanceId {
	std::uint16_t layer = 0;
	glm::ivec2 cell{0}; ///< In [-cell_limit, cell_limit). `pack` cannot represent other values.

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
