#pragma once

#include "core/placement/instance_data.hpp"
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

/// A column of `instance_rows`: its name, and its numbers as NumPy names them, "<u8" for unsigned integers of 8 bytes, "<f4" for floats of 4,
/// little-endian.
struct RowColumn {
	const char *name;
	const char *type;
};

/// Bytes before the columns of `instance_rows`.
inline constexpr std::size_t row_header_bytes = 16;

/// The columns of a layer's instances in their order: id, position, rotation as a quaternion, scale, thinning rank, what the layer's instance data adds,
/// and the mesh.
std::vector<RowColumn> row_columns(const InstanceData &data);

/// The instances of a tile as columns for tables and files, all numbers little-endian and each column without gaps: the number of
/// instances, of further floats an instance, of instances with a shear (see TurnAndScale), and a 0, 32 bits each; then `row_columns`, with `origin`
/// added to positions. Mesh by mesh, in the order of each. Throws std::bad_alloc.
std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes);

} // namespace thicket
