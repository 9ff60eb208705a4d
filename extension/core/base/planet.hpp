#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace thicket {

/// A planet. The up direction on it points away from its center, instead of along world y. Results
/// are bit-identical on every machine.
struct Planet {
	glm::dvec3 center{0.0}; ///< World meters.
	double radius = 0.0;    ///< Distance in meters from the center to altitude 0; 0 if there is no planet.

	/// No instances are placed more than this many radii below or above the center, along world y.
	/// This limits the number of tiles in a column of the map.
	static constexpr double radii_around = 2.0;

	bool exists() const { return radius > 0.0; }

	/// These functions return the lowest and the highest world y of instances.
	double bottom() const { return center.y - radii_around * radius; }
	double top() const { return center.y + radii_around * radius; }

	/// Returns the height above `radius`, in meters.
	double altitude(const glm::dvec3 &position) const { return std::sqrt(squared(position - center)) - radius; }

	/// Returns the up direction at a position relative to the center: the unit vector away from the
	/// center, or world y at the center itself.
	static glm::dvec3 up(const glm::dvec3 &from_center) {
		const double length = squared(from_center);
		return length > 0.0 ? from_center * (1.0 / std::sqrt(length)) : glm::dvec3(0.0, 1.0, 0.0);
	}
	glm::dvec3 up_at(const glm::dvec3 &position) const { return up(position - center); }

	/// Returns the position `offset` meters above `position`. Without a planet, up is world y.
	glm::dvec3 above(const glm::dvec3 &position, double offset) const {
		return exists() ? position + offset * up_at(position) : glm::dvec3(position.x, position.y + offset, position.z);
	}

	/// Returns a normal in a frame whose y axis is the up direction at a position. The frame's
	/// other axes are arbitrary, so only the slope of the result is meaningful.
	glm::vec3 upright(const glm::vec3 &normal, const glm::dvec3 &position) const {
		const glm::dvec3 upwards = up_at(position);
		const glm::dvec3 given(normal);
		const double along = given.x * upwards.x + given.y * upwards.y + given.z * upwards.z;
		const double horizontal = std::sqrt(squared(given - along * upwards));
		return {static_cast<float>(horizontal), static_cast<float>(along), 0.0f};
	}

	friend bool operator==(const Planet &, const Planet &) = default;

private:
	static double squared(const glm::dvec3 &v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
};

} // namespace thicket
