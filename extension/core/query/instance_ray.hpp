#pragma once

#include "core/query/instance_query.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// A straight line from one position to another; world meters.
struct Ray {
	glm::dvec3 from{0.0};
	glm::dvec3 along{0.0}; ///< The vector to the other end.

	glm::dvec3 at(double share) const { return from + share * along; }
};

/// A part of a ray, as shares of its length. Empty if the end lies before the start.
struct RayPart {
	double start = 0.0;
	double end = 1.0;

	bool empty() const { return !(start <= end); }
};

/// The part of `part` that lies between two values on one axis.
RayPart clipped(RayPart part, double from, double along, double low, double high);

/// Meters by which rounding may move a position on a ray.
double rounding_of(const Ray &ray);

/// The largest distance in meters from an instance's origin to the end of its cylinder at this scale, including
/// rounding.
double cylinder_reach(const InstanceShape &shape, double scale);

/// Tests which positions lie within `reach` meters of a ray. Never excludes such a position.
class ReachTest {
public:
	ReachTest(const Ray &ray, double reach);

	bool position(glm::dvec3 position) const;

	/// True if a position in a box may lie within reach. May return true although none does.
	bool box(glm::dvec3 min, glm::dvec3 max) const;

private:
	Ray ray_;
	double reach_;
	double per_squared_length_; ///< 0 for a ray without length.
};

/// The part of a ray inside the closed cylinder of an instance. Radius and height of the cylinder are in the instance's
/// own space, from its origin along its y axis. Empty if the ray misses the cylinder, or if the basis has no inverse.
RayPart inside_cylinder(const Ray &ray, const InstanceShape &shape, glm::dvec3 position, const glm::mat3 &basis);

} // namespace thicket
