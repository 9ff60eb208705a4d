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

/// A sample: one point of a frame at which the surface is evaluated.
struct FrameSample {
	float depth = -2.0F; ///< Distance toward the viewer in radii, -1 to 1; below -1 if the sample is empty.
	glm::vec3 color{0.0F};
	glm::vec3 normal{0.0F};

	bool is_covered() const { return depth >= -1.0F; }
};

/// The square region that a frame shows.
struct FrameView {
	ViewAxes axes;
	glm::vec3 center{0.0F};
	float radius = 1.0F; ///< Half of the width in meters; above 0, and large enough to enclose all triangles.
	/// Samples along each edge of a pixel. Mipmap levels are chosen per pixel, as in the engine.
	int samples = 1;
};

/// Rasterizes triangles to a square grid of samples, with a depth buffer. Corners are rounded to
/// 1/256 of a sample, and coverage is computed with integers, so neighboring triangles leave no
/// gaps.
class FrameRaster {
public:
	/// Allocates the samples. `side` is in samples, 1 to 4096. Throws std::bad_alloc.
	explicit FrameRaster(int side);

	void clear();

	/// Draws a surface, which must have passed ImpostorSurface::check(). The texture is multiplied
	/// by `tints`, one linear color per vertex. Throws std::bad_alloc.
	void draw(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const FrameView &view);

	int side() const { return side_; }
	/// Returns the samples, row by row from the top.
	std::span<const FrameSample> samples() const { return samples_; }

private:
	/// A vertex in the frame, in units of 1/256 of a sample. The origin is the frame's top left
	/// corner.
	struct Corner {
		std::int64_t x = 0;
		std::int64_t y = 0;
		float depth = 0.0F;
	};

	struct Triangle {
		std::array<std::size_t, 3> vertices{}; ///< Indices of the vertices, clockwise in the frame.
		std::int64_t double_area = 0;          ///< Twice the area in squared corner units; above 0.
		bool shows_back = false;
		glm::vec3 flat_normal{0.0F}; ///< Used for surfaces without normals.
		int texture_level = 0;
	};

	void project(std::span<const glm::vec3> positions, const FrameView &view);
	bool set_up(const ImpostorSurface &surface, std::size_t first_index, Triangle &r_triangle) const;
	void fill(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle);
	void shade(const ImpostorSurface &surface, std::span<const glm::vec4> tints, const Triangle &triangle,
			glm::vec3 weights, float depth, FrameSample &r_sample) const;

	int side_;
	std::vector<FrameSample> samples_;
	std::vector<Corner> corners_; ///< Vertices of the surface that is being drawn.
	double pixel_area_ = 0.0;     ///< Twice the area of a pixel of the current frame, in squared corner units.
};

} // namespace thicket
