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

/// How pixels represent biomes. Scenes store these values.
enum class BiomePixels : std::uint8_t {
	colors,  ///< By the nearest color; no biome if the pixel is more than half transparent.
	indices, ///< By the value of the red channel; no biome if none has that index.
};

/// Red, green and blue, 0 to 255.
struct BiomeColor {
	std::uint8_t index = 0;
	int red = 0;
	int green = 0;
	int blue = 0;
};

/// The color in the 8-bit steps of images.
BiomeColor biome_color(std::uint8_t index, const godot::Color &p_color);

/// An image in bytes: red, green, blue and alpha of each pixel, row by row.
struct ColorPixels {
	glm::ivec2 size{0}; ///< 0 if there is no image, or it cannot be read.
	godot::PackedByteArray bytes;
};

/// Reads any format that the engine can convert.
ColorPixels color_pixels(const godot::Ref<godot::Image> &p_image);

/// Returns the biome of each pixel. By color: the biome whose entry in `colors` is nearest; if several are equally
/// near, the one with the lowest index. By index: one of the first `count` biomes. Uses integer arithmetic.
std::vector<std::uint8_t> biomes_of(
		const ColorPixels &pixels, BiomePixels mode, std::span<const BiomeColor> colors, std::size_t count);

} // namespace thicket
