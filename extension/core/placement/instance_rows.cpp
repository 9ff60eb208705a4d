#include "core/placement/instance_rows.hpp"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace thicket {

namespace {

constexpr double shear_limit = 1e-3;
constexpr double same_scale = 1e-6;

/// Converts a rotation matrix to a quaternion, starting from the largest of its four components.
/// GLM's function is not used, because its rounding may differ between versions of GLM.
glm::dvec4 quaternion_of(const glm::dmat3 &rotation) {
	const double trace = rotation[0][0] + rotation[1][1] + rotation[2][2];
	if (trace > 0.0) {
		const double s = 2.0 * std::sqrt(trace + 1.0);
		return {(rotation[1][2] - rotation[2][1]) / s, (rotation[2][0] - rotation[0][2]) / s,
				(rotation[0][1] - rotation[1][0]) / s, 0.25 * s};
	}
	int i = rotation[1][1] > rotation[0][0] ? 1 : 0;
	i = rotation[2][2] > rotation[i][i] ? 2 : i;
	const int j = (i + 1) % 3;
	const int k = (i + 2) % 3;
	const double s = 2.0 * std::sqrt(std::max(1.0 + rotation[i][i] - rotation[j][j] - rotation[k][k], 0.0));
	glm::dvec4 result;
	result[i] = 0.25 * s;
	result[j] = (rotation[i][j] + rotation[j][i]) / s;
	result[k] = (rotation[i][k] + rotation[k][i]) / s;
	result[3] = (rotation[j][k] - rotation[k][j]) / s;
	return result;
}

glm::quat rounded(glm::dvec4 quaternion) {
	const double sign = quaternion.w < 0.0 ? -1.0 : 1.0;
	quaternion *= sign / std::sqrt(glm::dot(quaternion, quaternion));
	return {static_cast<float>(quaternion.w), static_cast<float>(quaternion.x), static_cast<float>(quaternion.y),
			static_cast<float>(quaternion.z)};
}

glm::dmat3 basis_of(std::span<const float, transform_floats> transform) {
	glm::dmat3 basis;
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			basis[column][row] = transform[static_cast<std::size_t>(4 * row + column)];
		}
	}
	return basis;
}

/// Writes numbers in little-endian order, one after the other.
class ColumnWriter {
public:
	explicit ColumnWriter(std::span<std::uint8_t> bytes) : at_(bytes.begin()) {}

	template <class Number>
	void put(Number number) {
		for (std::size_t byte = 0; byte < sizeof number; ++byte) {
			*at_++ = static_cast<std::uint8_t>(number >> 8 * byte);
		}
	}
	void put(float number) { put(std::bit_cast<std::uint32_t>(number)); }
	void put(double number) { put(std::bit_cast<std::uint64_t>(number)); }

private:
	std::span<std::uint8_t>::iterator at_;
};

/// The data of a tile from which its columns are written.
struct RowSource {
	glm::dvec3 origin{0.0};
	std::span<const MeshInstances *const> meshes;
	std::span<const RotationAndScale> rotated; ///< One entry for each instance, mesh by mesh.

	/// Calls `visit(instances, index, mesh)` for each instance. `index` is its index in
	/// `instances`, and `mesh` the index of the mesh.
	template <class Visit>
	void for_each(const Visit &visit) const {
		for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh) {
			for (std::size_t i = 0; i < meshes[mesh]->size(); ++i) {
				visit(*meshes[mesh], i, mesh);
			}
		}
	}
};

float float_of(const MeshInstances &mesh, std::size_t instance, std::size_t at) {
	return mesh.buffer[instance * mesh.stride + at];
}

/// A column and the function that writes it.
struct WrittenColumn {
	RowColumn column;
	void (*write)(const RowSource &, ColumnWriter &);
};

void write_ids(const RowSource &source, ColumnWriter &r_out) {
	source.for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) { r_out.put(mesh.ids[i]); });
}

template <int axis>
void write_position(const RowSource &source, ColumnWriter &r_out) {
	source.for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
		r_out.put(source.origin[axis] + double{float_of(mesh, i, 4 * axis + 3)});
	});
}

template <auto part>
void write_rotation(const RowSource &source, ColumnWriter &r_out) {
	std::ranges::for_each(source.rotated, [&](const RotationAndScale &each) { r_out.put(each.rotation.*part); });
}

template <int axis>
void write_scale(const RowSource &source, ColumnWriter &r_out) {
	std::ranges::for_each(source.rotated, [&](const RotationAndScale &each) { r_out.put(each.scale[axis]); });
}

void write_ranks(const RowSource &source, ColumnWriter &r_out) {
	source.for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) { r_out.put(mesh.ranks[i]); });
}

constexpr std::array leading_columns{
		WrittenColumn{{"id", "<u8"}, write_ids},
		WrittenColumn{{"x", "<f8"}, write_position<0>},
		WrittenColumn{{"y", "<f8"}, write_position<1>},
		WrittenColumn{{"z", "<f8"}, write_position<2>},
		WrittenColumn{{"qx", "<f4"}, write_rotation<&glm::quat::x>},
		WrittenColumn{{"qy", "<f4"}, write_rotation<&glm::quat::y>},
		WrittenColumn{{"qz", "<f4"}, write_rotation<&glm::quat::z>},
		WrittenColumn{{"qw", "<f4"}, write_rotation<&glm::quat::w>},
		WrittenColumn{{"scale_x", "<f4"}, write_scale<0>},
		WrittenColumn{{"scale_y", "<f4"}, write_scale<1>},
		WrittenColumn{{"scale_z", "<f4"}, write_scale<2>},
		WrittenColumn{{"rank", "<u4"}, write_ranks},
};

/// The columns that write_instance_data writes, in its order.
constexpr std::array color_columns{RowColumn{"color_r", "<f4"}, RowColumn{"color_g", "<f4"},
		RowColumn{"color_b", "<f4"}, RowColumn{"color_a", "<f4"}};
constexpr std::array custom_columns{RowColumn{"variation", "<f4"}, RowColumn{"wind_phase", "<f4"},
		RowColumn{"custom_rank", "<f4"}, RowColumn{"custom_scale", "<f4"}};
constexpr RowColumn model_column{"model", "<u2"};

/// The last character of a column's type is its size in bytes.
constexpr std::size_t bytes_of(const RowColumn &column) { return static_cast<std::size_t>(column.type[2] - '0'); }

std::size_t row_bytes(std::size_t extra_count) {
	std::size_t bytes = bytes_of(model_column) + extra_count * sizeof(float);
	for (const WrittenColumn &each : leading_columns) {
		bytes += bytes_of(each.column);
	}
	return bytes;
}

} // namespace

RotationAndScale rotation_and_scale(std::span<const float, transform_floats> transform) {
	RotationAndScale result;
	glm::dmat3 basis = basis_of(transform);
	const double mirror = glm::determinant(basis) < 0.0 ? -1.0 : 1.0;
	glm::dvec3 scale{glm::length(basis[0]), glm::length(basis[1]), glm::length(basis[2])};
	const double mean = (scale.x + scale.y + scale.z) / 3.0;
	if (glm::length(scale - mean) <= same_scale * mean) {
		scale = glm::dvec3(mean);
	}
	result.scale = glm::vec3(mirror * scale);
	if (scale.x == 0.0 || scale.y == 0.0 || scale.z == 0.0) {
		return result;
	}
	for (int column = 0; column < 3; ++column) {
		basis[column] *= mirror / glm::length(basis[column]);
	}
	result.sheared = std::max({std::abs(glm::dot(basis[0], basis[1])), std::abs(glm::dot(basis[0], basis[2])),
							 std::abs(glm::dot(basis[1], basis[2]))}) > shear_limit;
	// Orthonormalizes the basis as Godot does: x keeps its direction, and y stays in the plane of x
	// and y. If x and y are parallel, the rotation remains the identity.
	const glm::dvec3 y = basis[1] - basis[0] * glm::dot(basis[0], basis[1]);
	const double length = glm::length(y);
	if (length > same_scale) {
		result.rotation = rounded(quaternion_of({basis[0], y / length, glm::cross(basis[0], y / length)}));
	}
	return result;
}

std::vector<RowColumn> row_columns(const InstanceData &data) {
	std::vector<RowColumn> result;
	for (const WrittenColumn &each : leading_columns) {
		result.push_back(each.column);
	}
	if (data.use_colors) {
		result.insert(result.end(), color_columns.begin(), color_columns.end());
	}
	if (data.use_custom_data) {
		result.insert(result.end(), custom_columns.begin(), custom_columns.end());
	}
	result.push_back(model_column);
	return result;
}

std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes) {
	std::size_t rows = 0;
	for (const MeshInstances *mesh : meshes) {
		rows += mesh->size();
	}
	const std::size_t extra_count = meshes.empty() ? 0 : meshes.front()->stride - transform_floats;
	std::vector<RotationAndScale> rotated;
	rotated.reserve(rows);
	const RowSource placed{origin, meshes, {}};
	placed.for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
		rotated.push_back(
				rotation_and_scale(std::span(mesh.buffer).subspan(i * mesh.stride).first<transform_floats>()));
	});
	const RowSource source{origin, meshes, rotated};

	std::vector<std::uint8_t> bytes(row_header_bytes + rows * row_bytes(extra_count));
	ColumnWriter out(bytes);
	out.put(static_cast<std::uint32_t>(rows));
	out.put(static_cast<std::uint32_t>(extra_count));
	out.put(static_cast<std::uint32_t>(std::ranges::count(rotated, true, &RotationAndScale::sheared)));
	out.put(std::uint32_t{0});
	for (const WrittenColumn &each : leading_columns) {
		each.write(source, out);
	}
	for (std::size_t extra = 0; extra < extra_count; ++extra) {
		source.for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
			out.put(float_of(mesh, i, transform_floats + extra));
		});
	}
	source.for_each(
			[&](const MeshInstances &, std::size_t, std::size_t mesh) { out.put(static_cast<std::uint16_t>(mesh)); });
	return bytes;
}

} // namespace thicket
