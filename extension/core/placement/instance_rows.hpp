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

/// The rotation and scale of an instance: basis = rotation * diag(scale).
struct TurnAndScale {
	glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f}; ///< Has length 1, and w is not negative.
	/// All three are negative for a mirror image. Scales that agree to one part in 10^6 are made bit-identical.
	glm::vec3 scale{1.0f};
	bool sheared = false; ///< The transform also has a shear above one part in 1,000, which is left out.
};

/// Decomposes a transform, a 3 x 4 matrix given row by row. A column of length 0 becomes a scale of 0. A matrix with
/// such a column has no rotation.
TurnAndScale turn_and_scale(std::span<const float, transform_floats> transform);

/// A column of `instance_rows`: its name, and the type of its numbers in NumPy's notation. "<u8" is an unsigned integer of 8 bytes and
/// "<f4" a float of 4 bytes, both little-endian.
struct RowColumn {
	const char *name;
	const char *type;
};

/// Bytes before the columns of `instance_rows`.
inline constexpr std::size_t row_header_bytes = 16;

/// The columns of a layer's instances, in order: id, position, rotation as a quaternion, scale, thinning rank, the layer's instance data,
/// and the mesh.
std::vector<RowColumn> row_columns(const InstanceData &data);

/// The instances of a tile as columns for tables and files. All numbers are little-endian, and each column has no gaps. A header of four
/// 32-bit numbers comes first: the number of instances, of further floats per instance, of instances with a shear (see TurnAndScale), and a
/// 0. The `row_columns` follow, with `origin` added to positions. Instances are sorted by mesh, and keep their order within each mesh.
/// Throws std::bad_alloc.
std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes);

} // namespace thicket
