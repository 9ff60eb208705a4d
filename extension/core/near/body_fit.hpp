#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Bodies have no scale, so the scale goes into their shapes. Instances whose scales differ by less than this factor
/// share a shape. So a shape is up to 1 % larger or smaller than its instance.
inline constexpr double body_scale_step = 1.02;

/// The rotation and scale of an instance, as a body and its shape need them.
struct BodyFit {
	glm::mat3 rotation{1.0f};  ///< Right-handed; the second column is the instance's own up axis.
	glm::ivec3 scale_steps{0}; ///< Powers of body_scale_step along the rotated axes,
	bool mirrored = false;     ///< the third of them reversed.

	/// The scale along the axes that is used for the shape. The third is negative if the instance is mirrored.
	glm::vec3 scale() const;
};

/// Decomposes the basis of an instance into rotation and scale. A basis with a shear keeps its up axis. Returns false
/// for a basis that is flat along an axis, and for scales outside of 1e-4 to 1e4, because nothing can collide with such
/// an instance. The result is the same on every machine.
bool fit_body(const glm::mat3 &basis, BodyFit &r_fit);

/// Replaces `points` by at most `most` of them (4 or more), in their order. Keeps the points that lie farthest in
/// evenly spread directions, so that their convex hull is nearly the hull of all points. Does nothing if there are at
/// most `most` points.
void keep_outermost(std::vector<glm::vec3> &points, std::size_t most);

} // namespace thicket
