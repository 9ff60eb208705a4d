#pragma once

#include "core/rules/shape.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>

namespace thicket {

/// A box, sphere or cylinder made ready to be asked how deep a position lies in it.
class ShapeVolume {
public:
	ShapeVolume() = default;

	/// Of a valid shape of one of the three kinds.
	explicit ShapeVolume(const Shape &shape);

	/// Meters from `position` (world meters, within the shape) to the border, or to that of the shadow; 0 or less outside, and
	/// then not a distance. Exact to rounding; for the shadow of a leaning cylinder to 1e-12 of its size.
	double depth(glm::dvec3 position) const;

	/// Meters from the center to the shadow's last points, along x and along z.
	glm::dvec2 reach() const;

private:
	/// A pair of parallel sides of the shadow of a box.
	struct Sides {
		glm::dvec2 normal{0.0}; ///< 0 for none.
		double distance = 0.0;  ///< Of each to the center.
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
	glm::dvec2 lean_{0.0};     ///< Unit vector towards which a cylinder leans; 0 if it stands upright.
	double lean_length_ = 0.0; ///< Of the shadow of half its axis.
	double upright_ = 1.0;     ///< The cosine of the angle by which it leans.
};

} // namespace thicket
