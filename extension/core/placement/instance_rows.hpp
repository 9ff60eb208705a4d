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
struct RotationAndScale {
	glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f}; ///< Normalized, with w >= 0.
	/// The scale along each axis. All three scales are negative if the transform mirrors. Scales
	/// that agree to one part in 10^6 are made equal.
	glm::vec3 scale{1.0f};
	/// True if the transform also has a shear above one part in 1,000. The shear is omitted.
	bool sheared = false;
};

/// Decomposes a transform, a 3 x 4 matrix in row-major order. A column of length 0 becomes a scale
/// of 0, and the rotation is then the identity.
RotationAndScale rotation_and_scale(std::span<const float, transform_floats> transform);

/// A column of `instance_rows`: its name, and the type of its numbers in NumPy's notation. "<u8" is
/// an unsigned integer of 8 bytes and "<f4" a float of 4 bytes, both little-endian.
struct RowColumn {
	const char *name;
	const char *type;
};

/// Size in bytes of the header of `instance_rows`.
inline constexpr std::size_t row_header_bytes = 16;

/// Returns the columns of a layer's instances, in order: id, position, rotation as a quaternion,
/// scale, thinning rank, the layer's instance data, and the mesh.
std::vector<RowColumn> row_columns(const InstanceData &data);

/// Serializes the instances of a tile as contiguous columns of little-endian numbers, for tables
/// and files. A header of four 32-bit numbers comes first: the number of instances, the number of
/// floats per instance after the transform, the number of sheared instances, and 0. The
/// `row_columns` follow, with `origin` added to positions. Instances are sorted by mesh, and remain
/// in order within each mesh. Throws std::bad_alloc.
std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes);

} // namespace thicket
