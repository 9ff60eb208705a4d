#pragma once

// Helpers for the tests of single instances.

#include "core/placement/placement.hpp"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>

namespace thicket::test {

inline constexpr std::uint64_t seed = 1234567;
inline constexpr glm::vec3 up{0.0f, 1.0f, 0.0f};

/// Writes an instance's full transform. Returns the scale.
inline float write_transform(const Placement &placement, std::uint64_t set_seed, std::uint64_t id, glm::vec3 normal,
		glm::vec3 position, std::span<float, transform_floats> r_transform) {
	write_position(standing_position(placement, normal, position), r_transform);
	return write_basis(placement, set_seed, id, normal, r_transform);
}

/// A transform as read from the buffer. The columns of `basis` are the instance's axes.
struct Transform {
	glm::dmat3 basis{1.0};
	glm::dvec3 position{0.0};
	float scale = 0.0f;
};

inline Transform transform_of(
		const Placement &placement, std::uint64_t id, glm::vec3 normal = up, glm::vec3 position = glm::vec3(0.0f)) {
	std::array<float, transform_floats> floats{};
	Transform result;
	result.scale = write_transform(placement, seed, id, normal, position, floats);
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			result.basis[column][row] = double{floats[static_cast<std::size_t>(row * 4 + column)]};
		}
		result.position[row] = double{floats[static_cast<std::size_t>(row * 4 + 3)]};
	}
	return result;
}

inline glm::vec3 random_normal(std::mt19937 &random) {
	std::uniform_real_distribution<float> along(-1.0f, 1.0f);
	return glm::normalize(glm::vec3(along(random), 0.05f + std::abs(along(random)), along(random)));
}

} // namespace thicket::test
