#include "core/impostor/octahedron.hpp"

#include <glm/geometric.hpp>

#include <cmath>

namespace thicket {

namespace {

/// A direction is treated as vertical if its horizontal part has a squared length below this.
constexpr float least_horizontal = 1e-6F;

float signed_one(float value) { return value < 0.0F ? -1.0F : 1.0F; }

} // namespace

glm::vec3 octahedral_direction(glm::vec2 place, OctahedralSpan span) {
	glm::vec3 point;
	if (span == OctahedralSpan::hemisphere) {
		const float x = (place.x + place.y) * 0.5F;
		const float z = (place.x - place.y) * 0.5F;
		point = {x, 1.0F - std::abs(x) - std::abs(z), z};
	} else {
		point = {place.x, 1.0F - std::abs(place.x) - std::abs(place.y), place.y};
		if (point.y < 0.0F) {
			point.x = (1.0F - std::abs(place.y)) * signed_one(place.x);
			point.z = (1.0F - std::abs(place.x)) * signed_one(place.y);
		}
	}
	return point / std::sqrt(glm::dot(point, point));
}

PictureAxes picture_axes(glm::vec3 toward) {
	const float horizontal = toward.x * toward.x + toward.z * toward.z;
	glm::vec3 right(1.0F, 0.0F, 0.0F);
	if (horizontal >= least_horizontal) {
		const float length = std::sqrt(horizontal);
		right = {toward.z / length, 0.0F, -toward.x / length};
	}
	return {right, glm::cross(toward, right), toward};
}

} // namespace thicket
