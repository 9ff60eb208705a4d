#pragma once

#include "core/query/instance_query.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace thicket {

/// A line segment from one position to another, in world meters.
struct Ray {
	glm::dvec3 from{0.0};
	glm::dvec3 along{0.0}; ///< The vector from the start to the end.

	glm::dvec3 at(double fraction) const { return from + fraction * along; }
};

/// A part of a ray, in fractions of its length. Empty if the end is before the start.
struct RayPart {
	double start = 0.0;
	double end = 1.0;

	bool empty() const { return !(start <= end); }
};

/// Returns the part of `part` in which the ray is between `low` and `high` on one axis. `from` and
/// `along` are the ray's components on that axis.
RayPart clipped(RayPart part, double from, double along, double low, double high);

/// Returns an upper bound in meters for the rounding error of a position on a ray.
double rounding_of(const Ray &ray);

/// Returns the largest distance in meters from an instance's origin to any position in its cylinder
/// at this scale, including rounding.
double cylinder_reach(const InstanceShape &shape, double scale);

/// Tests whether positions are within `reach` meters of a ray. The test may accept positions
/// slightly farther away.
class ReachTest {
public:
	ReachTest(const Ray &ray, double reach);

	bool position(glm::dvec3 position) const;

	/// Returns false only if no position in the box is within reach.
	bool box(glm::dvec3 min, glm::dvec3 max) const;

private:
	Ray ray_;
	double reach_;
	double per_squared_length_; ///< 0 for a ray of length 0.
};

/// Returns the part of a ray inside the closed cylinder of an instance. The cylinder extends from
/// the instance's origin along its local y axis; its radius and height are in local space. The part
/// is empty if the ray misses the cylinder, or if the basis cannot be inverted.
RayPart inside_cylinder(const Ray &ray, const InstanceShape &shape, glm::dvec3 position, const glm::mat3 &basis);

} // namespace thicket
