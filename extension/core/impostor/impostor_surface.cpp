#include "core/impostor/impostor_surface.hpp"

#include "core/base/check.hpp"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace thicket {

namespace {

constexpr double max_component = 1e6; // Maximum absolute value of coordinates (in meters) and other components.

template <class Vector>
Status check_vectors(const char *property, std::span<const Vector> vectors, std::size_t count, double max) {
	if (!vectors.empty() && vectors.size() != count) {
		return Status::wrong_size(property, vectors.size(), exactly(count, "one per vertex"));
	}
	for (const Vector &vector : vectors) {
		for (int axis = 0; axis < Vector::length(); ++axis) {
			if (const Status status = check_range(property, vector[axis], -max, max); !status.ok()) {
				return status;
			}
		}
	}
	return {};
}

} // namespace

void ImpostorSurface::transform(const glm::mat3 &basis, glm::vec3 offset) {
	for (glm::vec3 &position : positions) {
		position = basis * position + offset;
	}
	// The cofactor matrix: the inverse transpose times the determinant. Unlike the inverse, it also
	// exists for flat bases.
	const glm::mat3 cofactors(
			glm::cross(basis[1], basis[2]), glm::cross(basis[2], basis[0]), glm::cross(basis[0], basis[1]));
	const bool mirrors = glm::dot(basis[0], cofactors[0]) < 0.0F;
	for (glm::vec3 &normal : normals) {
		const glm::vec3 transformed = mirrors ? -(cofactors * normal) : cofactors * normal;
		const float length = std::sqrt(glm::dot(transformed, transformed));
		normal = length > 0.0F ? transformed / length : normal;
	}
	for (std::size_t i = 0; mirrors && i + 2 < indices.size(); i += 3) {
		std::swap(indices[i + 1], indices[i + 2]);
	}
}

Status ImpostorSurface::check() const {
	if (indices.size() % 3 != 0) {
		return Status::wrong_size("indices", indices.size(), at_least(0, "a multiple of 3: three per triangle"));
	}
	for (const std::uint32_t index : indices) {
		if (index >= positions.size()) {
			return Status::out_of_range(
					"indices", index, at_most(static_cast<double>(positions.size()) - 1.0, "the last vertex"));
		}
	}
	const std::size_t count = positions.size();
	Status status = first_failure(check_vectors<glm::vec3>("vertices", positions, count, max_component),
			check_vectors<glm::vec3>("normals", normals, count, max_component),
			check_vectors<glm::vec2>("uvs", uvs, count, max_component),
			check_vectors<glm::vec4>("colors", colors, count, max_component),
			check_range("alpha_threshold", material.alpha_threshold, 0.0, 1.0));
	for (int channel = 0; channel < 4 && status.ok(); ++channel) {
		status = check_range("albedo", material.albedo[channel], 0.0, max_component);
	}
	return status;
}

} // namespace thicket
