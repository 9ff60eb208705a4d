#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The distances in meters of a box's nearest and farthest point from the viewer nearest to the box, as sight_distance
/// measures.
struct DistanceRange {
	double near = 0.0;
	double far = 0.0;
	double sight = 0.0; ///< Like `far`, for the end of sight: minus the meters that a viewer sees farther than others.

	DistanceRange() = default;
	DistanceRange(double its_near, double its_far) : DistanceRange(its_near, its_far, its_far) {}
	DistanceRange(double its_near, double its_far, double its_sight) : near(its_near), far(its_far), sight(its_sight) {}
};

/// The space that a camera sees, bounded by six planes. World meters.
class ViewVolume {
public:
	/// Takes the corners of the near side, in order around it, then the corners of the far side, in the same order. For
	/// perspective and orthogonal cameras.
	explicit ViewVolume(const std::array<glm::dvec3, 8> &corners) {
		glm::dvec3 middle(0.0);
		for (const glm::dvec3 &corner : corners) {
			middle += corner / 8.0;
		}
		constexpr std::array<std::array<std::size_t, 3>, 6> sides{
				{{0, 1, 2}, {4, 5, 6}, {0, 1, 5}, {1, 2, 6}, {2, 3, 7}, {3, 0, 4}}};
		for (std::size_t side = 0; side < sides.size(); ++side) {
			const auto &[a, b, c] = sides[side];
			// The far corners span long edges, which make the most exact normal.
			Plane &plane = planes_[side];
			plane.normal = glm::cross(corners[b] - corners[a], corners[c] - corners[a]);
			plane.offset = glm::dot(plane.normal, corners[c]);
			if (glm::dot(plane.normal, middle) < plane.offset) {
				plane.normal = -plane.normal;
				plane.offset = -plane.offset;
			}
		}
	}

	/// False if a box lies entirely outside of one of the planes, which is how renderers cull. A box near an edge may still count as
	/// visible.
	bool touches(glm::dvec3 min, glm::dvec3 max) const {
		for (const Plane &plane : planes_) {
			const glm::dvec3 inmost{plane.normal.x > 0.0 ? max.x : min.x, plane.normal.y > 0.0 ? max.y : min.y,
					plane.normal.z > 0.0 ? max.z : min.z};
			if (glm::dot(plane.normal, inmost) < plane.offset) {
				return false;
			}
		}
		return true;
	}

private:
	/// The visible side is the one to which the normal points.
	struct Plane {
		glm::dvec3 normal{0.0};
		double offset = 0.0;
	};
	std::array<Plane, 6> planes_;
};

} // namespace thicket
