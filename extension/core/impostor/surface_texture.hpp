#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr int max_texture_side = 1 << 14; ///< Maximum width and height in pixels.

/// The albedo texture of a surface: sRGB colors with alpha, repeated in both directions. Its
/// mipmaps average the stored bytes, as in the engine. A texture is immutable after `set`.
class SurfaceTexture {
public:
	/// Copies the pixels of `rgba`, row by row, with four bytes per pixel, and computes the
	/// mipmaps. Width and height must be 1 to max_texture_side. A failed call leaves the texture
	/// unchanged.
	Status set(int width, int height, std::span<const std::uint8_t> rgba);

	/// Returns the coarsest mipmap level whose pixels are at most as large as `area`, in pixels of
	/// the finest level.
	int level_for(double area) const;

	/// Returns the linear color and alpha at texture coordinates from 0 to 1 across the image,
	/// with v pointing down. The function interpolates between the pixel centers of the level. Coordinates
	/// that are not finite are treated as 0.
	glm::vec4 sample(glm::vec2 uv, int level_index) const;

	glm::ivec2 size() const { return {levels_.front().width, levels_.front().height}; }

private:
	struct Level {
		int width = 1;
		int height = 1;
		std::size_t first = 0; ///< Byte offset of the level.

		std::size_t byte_offset(int x, int y) const; ///< Returns the byte offset of a pixel.
	};

	glm::vec4 pixel(const Level &level, int x, int y) const;

	std::vector<Level> levels_{Level()};
	std::vector<std::uint8_t> pixels_{255, 255, 255, 255};
};

} // namespace thicket
