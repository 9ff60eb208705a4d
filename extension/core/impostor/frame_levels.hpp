#pragma once

#include "core/impostor/frame_raster.hpp"

#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

/// A pixel of a frame.
struct FramePixel {
	glm::vec3 color{0.0F}; ///< Linear RGB color.
	glm::vec3 normal{0.0F};
	float depth = 0.0F;    ///< Distance toward the viewer, in bounding-sphere radii.
	float coverage = 0.0F; ///< Covered fraction of the pixel, 0 to 1.
};

/// A frame and its mipmaps, averaged from samples. Empty pixels get values from coarser levels, so
/// that filtering never blends in a meaningless color.
class FrameLevels {
public:
	/// Allocates all levels. `side` is in pixels and must be a power of two. Throws std::bad_alloc.
	explicit FrameLevels(int side);

	/// Computes all levels from a raster, whose side must be a multiple of this frame's side.
	void compute(const FrameRaster &raster);

	int count() const { return static_cast<int>(levels_.size()); }
	int side(int level) const { return side_ >> level; }
	/// Returns the pixels of a level, row by row from the top.
	const std::vector<FramePixel> &level(int level) const { return levels_[static_cast<std::size_t>(level)]; }

private:
	void average(const FrameRaster &raster);
	void shrink(int level);
	void fill_holes(int level);

	int side_;
	std::vector<std::vector<FramePixel>> levels_;
};

} // namespace thicket
