#include "core/impostor/octahedron.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace thicket {

namespace {

/// A direction is treated as vertical if its horizontal part has a squared length below this.
constexpr float min_horizontal = 1e-6F;

float signed_one(float value) { return value < 0.0F ? -1.0F : 1.0F; }

} // namespace

glm::vec3 octahedral_direction(glm::vec2 position, OctahedralSpan span) {
	glm::vec3 point;
	if (span == OctahedralSpan::hemisphere) {
		const float x = (position.x + position.y) * 0.5F;
		const float z = (position.x - position.y) * 0.5F;
		point = {x, 1.0F - std::abs(x) - std::abs(z), z};
	} else {
		point = {position.x, 1.0F - std::abs(position.x) - std::abs(position.y), position.y};
		if (point.y < 0.0F) {
			point.x = (1.0F - std::abs(position.y)) * signed_one(position.x);
			point.z = (1.0F - std::abs(position.x)) * signed_one(position.y);
		}
	}
	return point / std::sqrt(glm::dot(point, point));
}

ViewAxes view_axes(glm::vec3 to_viewer) {
	const float horizontal = to_viewer.x * to_viewer.x + to_viewer.z * to_viewer.z;
	glm::vec3 right(1.0F, 0.0F, 0.0F);
	if (horizontal >= min_horizontal) {
		const float length = std::sqrt(horizontal);
		right = {to_viewer.z / length, 0.0F, -to_viewer.x / length};
	}
	return {right, glm::cross(to_viewer, right), to_viewer};
}

} // namespace thicket
