#pragma once

#include "core/impostor/impostor_surface.hpp"
#include "core/impostor/octahedron.hpp"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The content of one sample of a frame.
struct FrameSample {
	float depth = -2.0F; ///< Towards the viewer, in radii, -1 to 1; below -1 where it is empty.
	glm::vec3 color{0.0F};
	glm::vec3 normal{0.0F};

	bool is_covered() const { return depth >= -1.0F; }
};

/// The square that a frame covers.
struct FrameView {
	PictureAxes axes;
	glm::vec3 center{0.0F};
	float radius = 1.0F; ///< Meters; above 0, and large enough to enclose everything.
	int samples = 1;     ///< Per side of a pixel: texture resolution follows pixels, as in the engine.
};

/// Draws triangles into a square of samples with a depth buffer. Corners are rounded to 1/256 of a sample, and integers decide whether a
/// sample lies in a triangle, so neighboring triangles leave no gap.
class FrameRaster {
public:
	/// `side` is in samples, 1 to 4096. Throws std::bad_alloc if memory runs out.
	explicit FrameRaster(int side);

	void clear();

	/// Draws a surface that has passed its check. The texture is multiplied by `tints`, one for each vertex, in linear light.
	void draw(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const FrameView &view);

	int side() const { return side_; }
	/// Row by row from the top.
	std::span<const FrameSample> samples() const { return samples_; }

private:
	/// A vertex in the frame, in 1/256 of a sample from the left and from the top.
	struct Corner {
		std::int64_t x = 0;
		std::int64_t y = 0;
		float depth = 0.0F;
	};

	struct Triangle {
		std::array<std::size_t, 3> vertices{}; ///< Clockwise in the frame.
		std::int64_t double_area = 0;          ///< Above 0.
		bool shows_back = false;
		glm::vec3 flat_normal{0.0F}; ///< For surfaces without normals.
		int texture_level = 0;
	};

	void project(std::span<const glm::vec3> positions, const FrameView &view);
	bool set_up(const ImpostorSurface &surface, std::size_t first_index, Triangle &r_triangle) const;
	void fill(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle);
	void shade(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle,
			glm::vec3 weights, float depth, FrameSample &r_sample) const;

	int side_;
	std::vector<FrameSample> samples_;
	std::vector<Corner> corners_; ///< Corners of the surface that is being drawn.
	double pixel_area_ = 0.0;     ///< Twice the area of a pixel of the current frame, in units of the corners.
};

} // namespace thicket
