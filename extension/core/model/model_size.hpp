#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The size of a model in meters. The ground is at y = 0.
struct ModelSize {
	double width = 0.0; ///< Width of the bounding box, the average of x and z.
	/// The width that neighbors should leave free: three quarters of the model's horizontal slices
	/// are at most this wide. At least 0.6 of `width`.
	double footprint = 0.0;
	double base = 0.0;   ///< Width of the lowest tenth above the ground: the trunk of a tree.
	double height = 0.0; ///< Extent above y = 0.
	double depth = 0.0;  ///< Extent below y = 0.
	/// Enclosed volume as a fraction of the bounding box, 0 to 1. Leaf cards enclose no volume.
	double fill = 0.0;
};

/// Measures the size of a model from its triangles.
class ModelMeasure {
public:
	/// Prepares an empty measurement. `low` and `high` are the bounds of all triangles that will be
	/// added.
	ModelMeasure(const glm::dvec3 &low, const glm::dvec3 &high);

	/// Adds a triangle. Takes time proportional to the number of slices that the triangle touches.
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
