#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Physics bodies have no scale, so their shapes are scaled instead, in steps of this factor.
/// Instances whose scales round to the same step share a shape, which is up to 1 % larger or
/// smaller than the instance.
inline constexpr double body_scale_step = 1.02;

/// The rotation of a body and the scale of its shape, for one instance.
struct BodyFit {
	glm::mat3 rotation{1.0f};  ///< Right-handed. The second column is the instance's up axis.
	glm::ivec3 scale_steps{0}; ///< Exponents of body_scale_step for each rotated axis.
	bool mirrored = false;     ///< True if the third axis is reversed.

	/// Returns the scale of the shape along each axis. The third component is negative if the
	/// instance is mirrored.
	glm::vec3 scale() const;
};

/// Decomposes the basis of an instance into rotation and scale. A sheared basis keeps its up axis.
/// Returns false if the basis is flat along an axis or if a scale is not between 1e-4 and 1e4;
/// nothing can collide with such an instance. The result is the same on every machine.
bool fit_body(const glm::mat3 &basis, BodyFit &r_fit);

/// Reduces `points` to at most `max_count` of them, without changing their order. `max_count` must
/// be at least 4. The remaining points are the ones that lie farthest in evenly distributed
/// directions, so their convex hull approximates the convex hull of all points. Has no effect if
/// there are at most `max_count` points.
void keep_outermost(std::vector<glm::vec3> &points, std::size_t max_count);

} // namespace thicket
