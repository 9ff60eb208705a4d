#pragma once

#include "core/rules/shape.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>

namespace thicket {

/// A box, sphere or cylinder prepared for depth queries.
class ShapeVolume {
public:
	ShapeVolume() = default;

	/// Prepares `shape`, which must be a valid box, sphere or cylinder.
	explicit ShapeVolume(const Shape &shape);

	/// Returns the distance in meters from `position` (world meters) to the border, or to the
	/// border of the shadow if height is ignored. Outside, the result is 0 or less and is not a
	/// distance. It is exact up to rounding; for the shadow of a leaning cylinder, it is accurate
	/// to 1e-12 of the cylinder's size.
	double depth(glm::dvec3 position) const;

	/// Returns half the extent of the shadow along x and z, in meters.
	glm::dvec2 reach() const;

private:
	/// A pair of parallel sides of a box's shadow.
	struct Sides {
		glm::dvec2 normal{0.0}; ///< 0 if the pair does not exist.
		double distance = 0.0;  ///< Distance of each side from the center.
	};

	void prepare_shadow();
	double box_depth(glm::dvec3 offset) const;
	double cylinder_depth(glm::dvec3 offset) const;
	double box_shadow_depth(glm::dvec2 offset) const;
	double cylinder_shadow_depth(glm::dvec2 offset) const;

	ShapeKind kind_ = ShapeKind::sphere;
	bool shadow_ = false;
	glm::dvec3 center_{0.0};
	glm::dmat3 axes_{1.0};
	glm::dvec3 half_size_{0.0};
	std::array<Sides, 3> sides_{};
	glm::dvec2 lean_{0.0};     ///< Unit vector in the direction in which a cylinder leans; 0 if it is upright.
	double lean_length_ = 0.0; ///< Length of the shadow of half the cylinder's axis.
	double upright_ = 1.0;     ///< Cosine of the angle by which the cylinder leans.
};

} // namespace thicket
