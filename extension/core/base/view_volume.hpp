#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The sight distances, in meters, from the nearest viewer to the nearest and the farthest point of
/// a box; see sight_distance().
struct DistanceRange {
	double near = 0.0;
	double far = 0.0;
	/// `far` minus the distance in meters by which the viewer sees farther than usual. It is
	/// compared with Sight::end.
	double sight = 0.0;

	DistanceRange() = default;
	DistanceRange(double its_near, double its_far) : DistanceRange(its_near, its_far, its_far) {}
	DistanceRange(double its_near, double its_far, double its_sight) : near(its_near), far(its_far), sight(its_sight) {}
};

/// The space visible to a camera, bounded by six planes, in world meters.
class ViewVolume {
public:
	/// Creates the volume between eight corners: the corners of the near plane, in order around it,
	/// followed by the corners of the far plane in the same order. Perspective and orthogonal
	/// cameras are supported.
	explicit ViewVolume(const std::array<glm::dvec3, 8> &corners) {
		glm::dvec3 middle(0.0);
		for (const glm::dvec3 &corner : corners) {
			middle += corner / 8.0;
		}
		constexpr std::array<std::array<std::size_t, 3>, 6> sides{
				{{0, 1, 2}, {4, 5, 6}, {0, 1, 5}, {1, 2, 6}, {2, 3, 7}, {3, 0, 4}}};
		for (std::size_t side = 0; side < sides.size(); ++side) {
			const auto &[a, b, c] = sides[side];
			// All planes except the near one use a far corner, because long edges produce a more
			// accurate normal.
			Plane &plane = planes_[side];
			plane.normal = glm::cross(corners[b] - corners[a], corners[c] - corners[a]);
			plane.offset = glm::dot(plane.normal, corners[c]);
			if (glm::dot(plane.normal, middle) < plane.offset) {
				plane.normal = -plane.normal;
				plane.offset = -plane.offset;
			}
		}
	}

	/// Returns false if a box lies entirely outside one of the planes. Renderers cull in the same
	/// way. A box near an edge of the volume may be reported as visible even if it is not.
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
	/// The normal points to the visible side.
	struct Plane {
		glm::dvec3 normal{0.0};
		double offset = 0.0;
	};
	std::array<Plane, 6> planes_;
};

} // namespace thicket
