#pragma once

#include "core/impostor/frame_raster.hpp"

#include <glm/vec3.hpp>

#include <vector>

namespace thicket {

/// A pixel of a frame.
struct FramePixel {
	glm::vec3 color{0.0F}; ///< In linear light.
	glm::vec3 normal{0.0F};
	float depth = 0.0F;    ///< In radii.
	float coverage = 0.0F; ///< 0 to 1.
};

/// A frame and its mip maps, averaged from samples. Empty pixels take over nearby values from coarser levels, so that no filter mixes in a
/// meaningless color.
class FrameLevels {
public:
	/// `side` is in pixels, a power of two. Throws std::bad_alloc if memory runs out.
	explicit FrameLevels(int side);

	/// Reads a raster whose side is a multiple of this frame's side.
	void take(const FrameRaster &raster);

	int count() const { return static_cast<int>(levels_.size()); }
	int side(int level) const { return side_ >> level; }
	/// Row by row from the top.
	const std::vector<FramePixel> &level(int level) const { return levels_[static_cast<std::size_t>(level)]; }

private:
	void average(const FrameRaster &raster);
	void shrink(int level);
	void fill_holes(int level);

	int side_;
	std::vector<std::vector<FramePixel>> levels_;
};

} // namespace thicket
