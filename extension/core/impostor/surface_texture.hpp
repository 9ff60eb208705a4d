#pragma once

#include "core/base/status.hpp"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

inline constexpr int max_texture_side = 1 << 14; ///< Pixels.

/// The albedo texture of a surface: sRGB colors with alpha, tiled over the plane. Its mip maps are averages of the bytes, as in the engine.
/// Immutable after `set`.
class SurfaceTexture {
public:
	/// `rgba` is row by row, x fastest, four bytes per pixel. Each side must be 1 to max_texture_side. Refuses anything
	/// else and changes nothing.
	Status set(int width, int height, std::span<const std::uint8_t> rgba);

	/// The level whose pixels are at most as large as `area`, which is in pixels of the finest level.
	int level_for(double area) const;

	/// The color in linear light, and alpha, at texture coordinates (0 to 1 over the image, v down), interpolated between the centers of
	/// the level's pixels. Coordinates that are not finite count as 0.
	glm::vec4 sample(glm::vec2 uv, int level) const;

	glm::ivec2 size() const { return {levels_.front().width, levels_.front().height}; }

private:
	struct Level {
		int width = 1;
		int height = 1;
		std::size_t first = 0; ///< Byte.

		std::size_t place(int x, int y) const; ///< The index of a pixel's first byte.
	};

	glm::vec4 pixel(const Level &level, int x, int y) const;

	std::vector<Level> levels_{Level()};
	std::vector<std::uint8_t> pixels_{255, 255, 255, 255};
};

} // namespace thicket
