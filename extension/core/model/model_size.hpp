#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The size of a model that stands on y = 0. Meters.
struct ModelSize {
	double width = 0.0; ///< Of the whole, the average of x and z.
	double footprint =
			0.0; ///< The width that neighbors should leave free. Three of four slices are at most as wide. At least 0.6 of `width`.
	double base = 0.0;   ///< Width of the lowest tenth above the ground: the trunk of a tree.
	double height = 0.0; ///< Above y = 0.
	double depth = 0.0;  ///< Below y = 0.
	double fill = 0.0;   ///< Enclosed volume as a part of the bounding box, 0 to 1. Leaves on cards enclose nothing.
};

/// Measures triangles.
class ModelMeasure {
public:
	/// `low` and `high` are the bounds of all triangles.
	ModelMeasure(const glm::dvec3 &low, const glm::dvec3 &high);

	/// O(slices that the triangle enters).
	void add(const std::array<glm::dvec3, 3> &triangle);

	ModelSize size() const;

private:
	static constexpr std::size_t slices = 20;

	struct Extent {
		double low_x;
		double high_x;
		double low_z;
		double high_z;

		bool is_empty() const { return high_x < low_x; }
		double width() const { return is_empty() ? 0.0 : 0.5 * (high_x - low_x + high_z - low_z); }
		void add(double x, double z);
		void add(const Extent &other);
	};
	static const Extent nothing;

	Extent extent_between(double bottom, double top) const;

	glm::dvec3 low_;
	glm::dvec3 high_;
	std::array<Extent, slices> extents_;
	double volume_ = 0.0;
};

} // namespace thicket
