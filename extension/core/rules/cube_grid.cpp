#include "core/rules/cube_grid.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thicket {

namespace {

/// The distance between the areas of two faces on the plane, in pixels. It is a multiple of the side of
/// a block of a PaintedMask.
constexpr int face_distance = 1 << 28;

/// Maximum number of nodes along an edge of a face. A planet with more pixels has larger pixels.
constexpr int max_count = (1 << 27) - 1;

/// The places of the faces +x, -x, +y, -y, +z and -z in the row of areas on the plane.
constexpr std::array<int, CubeGrid::faces> face_slots{1, -1, 0, -3, 2, -2};

/// The axis of space along which a face points, and the axes of its columns and rows. The columns of
/// the face toward +y are along x, and its rows along z.
constexpr int axis_of(int face) { return face / 2; }
constexpr int column_axis(int face) { return (axis_of(face) + 2) % 3; }
constexpr int row_axis(int face) { return (axis_of(face) + 1) % 3; }
constexpr double side_of(int face) { return face % 2 == 0 ? 1.0 : -1.0; }

} // namespace

CubeGrid::CubeGrid(double planet_radius, double pixel_size) {
	const double half_face = std::numbers::pi / 4.0 * planet_radius / pixel_size; // Half of a face, in pixels.
	count_ = 2 * static_cast<int>(std::clamp(std::floor(half_face), 0.0, 0.5 * (max_count - 1))) + 1;
}

CubeGrid::Place CubeGrid::at(const glm::dvec3 &from_center) const {
	const glm::dvec3 size = glm::abs(from_center);
	const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
	Place place{2 * axis + (from_center[axis] < 0.0 ? 1 : 0), {}};
	const std::array<int, 2> axes{column_axis(place.face), row_axis(place.face)};
	for (int i = 0; i < 2; ++i) {
		const double along = from_center[axes[static_cast<std::size_t>(i)]];
		const double angle = angle_degrees(std::abs(along), size[axis]);
		place.position[i] = (0.5 + (along < 0.0 ? -angle : angle) / 90.0) * count_;
	}
	return place;
}

double CubeGrid::tangent(double position) const {
	const Rotation rotation = rotation_by((position / count_ - 0.5) / 4.0);
	return rotation.sine / rotation.cosine;
}

glm::dvec3 CubeGrid::direction(int face, glm::dvec2 tangents) {
	glm::dvec3 result;
	result[axis_of(face)] = side_of(face);
	result[column_axis(face)] = tangents.x;
	result[row_axis(face)] = tangents.y;
	return Planet::up(result);
}

int CubeGrid::storing_face(int face, glm::ivec2 &r_node) const {
	glm::ivec3 node;
	node[axis_of(face)] = face % 2 == 0 ? count_ : 0;
	node[column_axis(face)] = r_node.x;
	node[row_axis(face)] = r_node.y;
	int axis = 0;
	while (node[axis] != 0 && node[axis] != count_) {
		++axis;
	}
	const int result = 2 * axis + (node[axis] == 0 ? 1 : 0);
	r_node = {node[column_axis(result)], node[row_axis(result)]};
	return result;
}

bool CubeGrid::stores(int face, glm::ivec2 node) const { return is_inside(node) || storing_face(face, node) == face; }

glm::ivec2 CubeGrid::corner(int face) const {
	// The middle of the face is between two pixels, as the origin of the plane.
	const int first = -(count_ + 1) / 2;
	return {face_slots[static_cast<std::size_t>(face)] * face_distance + first, first};
}

glm::ivec2 CubeGrid::pixel(int face, glm::ivec2 node) const {
	const int storing = is_inside(node) ? face : storing_face(face, node);
	return corner(storing) + node;
}

PixelRect CubeGrid::nodes_in(int face, const PlanetCap &cap) const {
	PixelRect result{{0, 0}, glm::ivec2(count_ + 1)};
	const std::array<int, 2> axes{column_axis(face), row_axis(face)};
	for (int i = 0; i < 2 && !cap.is_whole(); ++i) {
		// A grid line is a plane through the center, so its coordinate is an angle about an axis.
		const double across = cap.middle[axes[static_cast<std::size_t>(i)]];
		const double along = cap.middle[axis_of(face)] * side_of(face);
		const double squared = across * across + along * along - cap.sine * cap.sine;
		if (!(squared > 0.0)) {
			// The cap touches the axis, so it contains all angles.
			continue;
		}
		const double angle = angle_degrees(std::abs(across), along);
		const double middle = across < 0.0 ? -angle : angle;
		const double reach = angle_degrees(cap.sine, std::sqrt(squared)) + angle_rounding;
		const double from = (0.5 + (middle - reach) / 90.0) * count_ - 1.0;
		const double to = (0.5 + (middle + reach) / 90.0) * count_ + 1.0;
		if (to < 0.0 || from > count_) {
			return {};
		}
		result.min[i] = static_cast<int>(std::clamp(std::ceil(from), 0.0, double{1.0} * count_));
		result.max[i] = static_cast<int>(std::clamp(std::floor(to), 0.0, double{1.0} * count_)) + 1;
	}
	return result;
}

PlanetCap CubeGrid::cap_of(int face, const PixelRect &nodes) const {
	const glm::dvec2 min(tangent(nodes.min.x), tangent(nodes.min.y));
	const glm::dvec2 max(tangent(nodes.max.x - 1), tangent(nodes.max.y - 1));
	const glm::dvec3 middle = direction(face, 0.5 * (min + max));
	double cosine = 1.0;
	for (const glm::dvec2 at : {min, max, glm::dvec2(min.x, max.y), glm::dvec2(max.x, min.y)}) {
		cosine = std::min(cosine, glm::dot(middle, direction(face, at)));
	}
	// Each node affects the values up to its neighbors.
	const double neighbors = 2.0 * (std::numbers::pi / 2.0) / count_;
	return {middle, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) + neighbors + 1e-7};
}

} // namespace thicket
