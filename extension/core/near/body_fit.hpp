#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Bodies take no scale, so it goes into their shapes; these are shared between instances whose scales differ by less than this factor.
/// A shape is up to half of it, 1 %, larger or smaller than its instance.
inline constexpr double body_scale_step = 1.02;

/// How an instance stands, as a body and its shape take it.
struct BodyFit {
	glm::mat3 rotation{1.0f};  ///< Right-handed; the second column is the instance's own up axis.
	glm::ivec3 scale_steps{0}; ///< Powers of body_scale_step along the rotated axes,
	bool mirrored = false;     ///< the third of them backwards.

	/// The scale along the axes, as the shape has it; the third is negative where it is mirrored.
	glm::vec3 scale() const;
};

/// Takes the rotation and scale of an instance apart. A basis that shears keeps its up axis. False for one that is flat along an axis,
/// and for scales outside of 1e-4 to 1e4: nothing can bump into that. The same on every machine.
bool fit_body(const glm::mat3 &basis, BodyFit &r_fit);

/// Replaces `points` by at most `most` of them (4 or more), in their order: those farthest in directions that are spread evenly, so that
/// their convex hull is nearly that of all. Fewer points than that stay as they are.
void keep_outermost(std::vector<glm::vec3> &points, std::size_t most);

} // namespace thicket
