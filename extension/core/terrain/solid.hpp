#pragma once

#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

// Functions for triangles of simple solids that are centered on the origin, with three corners
// each. Seen from outside, the corners run clockwise, like those of the engine's meshes. All
// functions throw std::bad_alloc.

/// Appends the 12 triangles of a box with edges of `size` meters.
void append_box(const glm::dvec3 &size, std::vector<glm::vec3> &r_corners);

/// Appends a cylinder with its axis along y. Lengths are in meters.
void append_cylinder(double radius, double height, std::vector<glm::vec3> &r_corners);

/// Appends a capsule with its axis along y. Lengths are in meters; `height` includes the round ends,
/// so a height of twice the radius is a sphere.
void append_capsule(double radius, double height, std::vector<glm::vec3> &r_corners);

/// Returns the number of flat sides that represent a circle of `radius` meters, a power of two from
/// 16 to 512. For circles of up to 265 m, no side is more than 5 mm inside the circle.
int sides_of(double radius);

} // namespace thicket
