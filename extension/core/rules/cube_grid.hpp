#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/rules/planet_cap.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <numbers>

namespace thicket {

/// A grid of nodes over a whole planet, without poles: each face of a cube around the planet has a
/// square grid whose lines are at equal angles. The grid determines which pixels of a PaintedMask
/// belong to which directions.
///
/// Neighboring nodes are about a pixel apart: between 0.7 pixels, in the middle of an edge of a face,
/// and 1 pixel, in the middle of a face. Nodes on an edge belong to all faces that meet there, but only
/// one of the faces stores them. Values that are interpolated between nodes are therefore continuous
/// everywhere.
///
/// Each face has its own area of the mask's plane. The face toward +y is around the origin of the plane,
/// with +x and +z as on the ground. Results are bit-identical on every machine.
class CubeGrid {
public:
	static constexpr int faces = 6;

	/// A position on a face, in nodes from the face's corner: 0 to count() along both axes.
	struct Place {
		int face = 0;
		glm::dvec2 position{0.0};
	};

	/// `planet_radius` and `pixel_size` are in meters, above 0.
	CubeGrid(double planet_radius, double pixel_size);

	/// Returns the number of intervals along an edge of a face, which is odd.
	int count() const { return count_; }

	/// Returns the distance between nodes in the middle of a face, in meters: nearly the pixel size, except on
	/// tiny and huge planets.
	double spacing(double planet_radius) const { return std::numbers::pi / 2.0 * planet_radius / count_; }

	/// Returns the place of a direction from the planet's center, which need not be normalized. All
	/// components must be finite, and one of them must not be 0.
	Place at(const glm::dvec3 &from_center) const;

	/// Returns the tangent of the angle between the middle of a face and a position along one axis.
	/// Positions may extend beyond the face by less than half of its size.
	double tangent(double position) const;

	/// Returns the unit vector from the center to a position on a face, from the tangents of its two
	/// coordinates.
	static glm::dvec3 direction(int face, glm::dvec2 tangents);

	/// Returns true if this face stores the node.
	bool stores(int face, glm::ivec2 node) const;

	/// Returns the pixel that stores a node of a face. Both coordinates are 0 to count().
	glm::ivec2 pixel(int face, glm::ivec2 node) const;

	/// Returns the pixel of node (0, 0) of a face, if the face stored all of its nodes.
	glm::ivec2 corner(int face) const;

	/// Returns the nodes of a face whose directions may be in a cap.
	PixelRect nodes_in(int face, const PlanetCap &cap) const;

	/// Returns a cap that contains every direction whose value depends on a node in `nodes`, which must
	/// not be empty.
	PlanetCap cap_of(int face, const PixelRect &nodes) const;

private:
	/// Returns true if a node is not on an edge of its face.
	bool is_inside(glm::ivec2 node) const { return node.x > 0 && node.y > 0 && node.x < count_ && node.y < count_; }

	/// Returns the face that stores a node, and changes the node's coordinates to those on that face.
	int storing_face(int face, glm::ivec2 &r_node) const;

	int count_;
};

} // namespace thicket
