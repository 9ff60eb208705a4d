#pragma once

#include "core/placement/tile_instances.hpp"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// How an instance is turned and scaled: basis = rotation * diag(scale).
struct TurnAndScale {
	glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f}; ///< Of length 1, w not negative.
	glm::vec3 scale{
			1.0f};        ///< All three negative for a mirror image; equal to the bit where they are to a part in 10^6.
	bool sheared = false; ///< The transform has a shear besides, above a part in 1,000, which is left out.
};

/// Takes a transform apart, of which a 3 x 4 matrix is given row by row. A column of length 0 is a scale of 0; a matrix that has one
/// is not turned.
TurnAndScale turn_and_scale(std::span<const float, transform_floats> transform);

/// Bytes before the columns of `instance_rows`, and of one instance in them beside its further floats.
inline constexpr std::size_t row_header_bytes = 16;
inline constexpr std::size_t row_bytes = 8 + 3 * 8 + 7 * 4 + 4 + 2;

/// The instances of a tile as columns for tables and files, all numbers little-endian and each column without gaps: the number of
/// instances, of further floats an instance, of instances with a shear (see TurnAndScale), and a 0, 32 bits each; then the
/// columns id (64 bits), x, y, z (doubles, `origin` added), the rotation's x, y, z, w, the scale's x, y, z (floats), the thinning
/// rank (32 bits), each of the further floats, and the mesh (16 bits). Mesh by mesh, in the order of each. Throws std::bad_alloc.
std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes);

} // namespace thicket
