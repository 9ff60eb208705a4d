#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// The relation between the engine's space and a node's world, which contains its points:
/// world = turn * engine + offset.
struct WorldFrame {
	glm::dvec3 offset{0.0};   ///< The world position of the engine's origin, in meters.
	glm::dmat3 rotation{1.0}; ///< A rotation. The identity unless `local` is true.
	bool local = false;       ///< True if the world is the node's local space and moves with the node.

	bool operator==(const WorldFrame &) const = default;

	/// Returns the frame of a node's local space from the node's global transform. Ignores any scale
	/// of `axes`.
	static WorldFrame of_local_space(glm::dmat3 axes, glm::dvec3 origin) {
		axes[0] = glm::normalize(axes[0]);
		axes[1] = glm::normalize(axes[1] - glm::dot(axes[0], axes[1]) * axes[0]);
		axes[2] = glm::cross(axes[0], axes[1]);
		const glm::dmat3 rotation = glm::transpose(axes);
		return {-(rotation * origin), rotation, true};
	}

	/// Converts a direction, a basis or a position of the engine to the world, and back.
	glm::dmat3 rotated(const glm::dmat3 &basis) const { return local ? rotation * basis : basis; }
	glm::mat3 rotated_back(const glm::mat3 &basis) const {
		return local ? glm::mat3(glm::transpose(rotation) * glm::dmat3(basis)) : basis;
	}
	glm::dvec3 to_world(glm::dvec3 position) const { return (local ? rotation * position : position) + offset; }
	glm::dvec3 to_engine(glm::dvec3 position) const {
		return local ? glm::transpose(rotation) * (position - offset) : position - offset;
	}
};

} // namespace thicket
