#pragma once

#include "core/rules/biome_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/color.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// How pixels encode biomes. Scenes store these numbers, so keep them stable.
enum class BiomePixels : std::uint8_t {
	/// The biome with the nearest color; none if the pixel's alpha is below 128 of 255.
	colors,
	/// The biome whose index is the red channel's value; none if no biome has that index.
	indices,
};

/// The map color of a biome, 0 to 255 per channel.
struct BiomeColor {
	std::uint8_t index = 0;
	int red = 0;
	int green = 0;
	int blue = 0;
};

/// Converts a color to 8 bits per channel. Clamps channels to [0, 1].
BiomeColor biome_color(std::uint8_t index, const godot::Color &p_color);

/// The pixels of an image as RGBA bytes, row by row.
struct ColorPixels {
	glm::ivec2 size{0}; ///< (0, 0) if there is no readable image.
	godot::PackedByteArray bytes;
};

/// Converts a copy of an image of any format. Returns no pixels for a null or empty image, or if it
/// cannot be decompressed.
ColorPixels color_pixels(const godot::Ref<godot::Image> &p_image);

/// Returns the biome of each pixel, or no_biome. In color mode, picks the entry of `colors` with
/// the smallest distance, or the first of several that are equally near. In index mode, accepts
/// indices below `count`. Uses only integer arithmetic, so results are the same on every machine.
std::vector<std::uint8_t> biomes_of(
		const ColorPixels &pixels, BiomePixels mode, std::span<const BiomeColor> colors, std::size_t count);

} // namespace thicket
