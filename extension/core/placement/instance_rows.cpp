#include "core/placement/instance_rows.hpp"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace thicket {

namespace {

constexpr double shear_limit = 1e-3;
constexpr double same_scale = 1e-6;

/// Of a matrix with columns of length 1 that are at right angles and no mirror image, by the largest of the four numbers. Not GLM's:
/// that is free to take other steps in another version.
glm::dvec4 quaternion_of(const glm::dmat3 &turn) {
	const double trace = turn[0][0] + turn[1][1] + turn[2][2];
	if (trace > 0.0) {
		const double s = 2.0 * std::sqrt(trace + 1.0);
		return {(turn[1][2] - turn[2][1]) / s, (turn[2][0] - turn[0][2]) / s, (turn[0][1] - turn[1][0]) / s, 0.25 * s};
	}
	int i = turn[1][1] > turn[0][0] ? 1 : 0;
	i = turn[2][2] > turn[i][i] ? 2 : i;
	const int j = (i + 1) % 3;
	const int k = (i + 2) % 3;
	const double s = 2.0 * std::sqrt(std::max(1.0 + turn[i][i] - turn[j][j] - turn[k][k], 0.0));
	glm::dvec4 result;
	result[i] = 0.25 * s;
	result[j] = (turn[i][j] + turn[j][i]) / s;
	result[k] = (turn[i][k] + turn[k][i]) / s;
	result[3] = (turn[j][k] - turn[k][j]) / s;
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

/// Writes numbers of one column after the other.
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

} // namespace

TurnAndScale turn_and_scale(std::span<const float, transform_floats> transform) {
	TurnAndScale result;
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
	// As the engine makes a basis orthonormal: x stays, y stays in its plane with x. What is flat all the same is not turned.
	const glm::dvec3 y = basis[1] - basis[0] * glm::dot(basis[0], basis[1]);
	const double length = glm::length(y);
	if (length > same_scale) {
		result.rotation = rounded(quaternion_of({basis[0], y / length, glm::cross(basis[0], y / length)}));
	}
	return result;
}

std::vector<std::uint8_t> instance_rows(glm::dvec3 origin, std::span<const MeshInstances *const> meshes) {
	std::size_t rows = 0;
	for (const MeshInstances *mesh : meshes) {
		rows += mesh->size();
	}
	const std::size_t further = meshes.empty() ? 0 : meshes.front()->stride - transform_floats;
	std::vector<TurnAndScale> turned;
	turned.reserve(rows);
	const auto for_each = [meshes](const auto &visit) {
		for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh) {
			for (std::size_t i = 0; i < meshes[mesh]->size(); ++i) {
				visit(*meshes[mesh], i, mesh);
			}
		}
	};
	const auto floats_of = [](const MeshInstances &mesh, std::size_t i) {
		return std::span(mesh.buffer).subspan(i * mesh.stride, mesh.stride);
	};
	for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
		turned.push_back(turn_and_scale(floats_of(mesh, i).first<transform_floats>()));
	});

	std::vector<std::uint8_t> bytes(row_header_bytes + rows * (row_bytes + further * sizeof(float)));
	ColumnWriter out(bytes);
	out.put(static_cast<std::uint32_t>(rows));
	out.put(static_cast<std::uint32_t>(further));
	out.put(static_cast<std::uint32_t>(std::ranges::count(turned, true, &TurnAndScale::sheared)));
	out.put(std::uint32_t{0});
	for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) { out.put(mesh.ids[i]); });
	for (int axis = 0; axis < 3; ++axis) {
		for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
			out.put(origin[axis] + double{floats_of(mesh, i)[static_cast<std::size_t>(4 * axis + 3)]});
		});
	}
	for (const auto part : {&glm::quat::x, &glm::quat::y, &glm::quat::z, &glm::quat::w}) {
		std::ranges::for_each(turned, [&](const TurnAndScale &each) { out.put(each.rotation.*part); });
	}
	for (int axis = 0; axis < 3; ++axis) {
		std::ranges::for_each(turned, [&](const TurnAndScale &each) { out.put(each.scale[axis]); });
	}
	for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) { out.put(mesh.ranks[i]); });
	for (std::size_t more = 0; more < further; ++more) {
		for_each([&](const MeshInstances &mesh, std::size_t i, std::size_t) {
			out.put(floats_of(mesh, i)[transform_floats + more]);
		});
	}
	for_each([&](const MeshInstances &, std::size_t, std::size_t mesh) { out.put(static_cast<std::uint16_t>(mesh)); });
	return bytes;
}

} // namespace thicket
