#include "nodes/biome/biome_image.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

using namespace godot;

namespace thicket {

namespace {

int byte_of(float channel) { return static_cast<int>(std::lround(255.0F * std::clamp(channel, 0.0F, 1.0F))); }

std::uint8_t nearest_biome(const std::uint8_t *rgb, std::span<const BiomeColor> colors) {
	std::uint8_t result = no_biome;
	int min_difference = std::numeric_limits<int>::max();
	for (const BiomeColor &color : colors) {
		const int red = rgb[0] - color.red;
		const int green = rgb[1] - color.green;
		const int blue = rgb[2] - color.blue;
		const int difference = red * red + green * green + blue * blue;
		if (difference < min_difference) {
			min_difference = difference;
			result = color.index;
		}
	}
	return result;
}

} // namespace

BiomeColor biome_color(std::uint8_t index, const Color &p_color) {
	return {index, byte_of(p_color.r), byte_of(p_color.g), byte_of(p_color.b)};
}

ColorPixels color_pixels(const Ref<Image> &p_image) {
	ColorPixels result;
	if (p_image.is_null() || p_image->get_width() <= 0 || p_image->get_height() <= 0) {
		return result;
	}
	const Ref<Image> image = p_image->duplicate();
	if (image->is_compressed() && image->decompress() != OK) {
		return result;
	}
	image->clear_mipmaps();
	image->convert(Image::FORMAT_RGBA8);
	const PackedByteArray bytes = image->get_data();
	const glm::ivec2 size{image->get_width(), image->get_height()};
	if (bytes.size() == int64_t{4} * size.x * size.y) {
		result = {size, bytes};
	}
	return result;
}

std::vector<std::uint8_t> biomes_of(
		const ColorPixels &pixels, BiomePixels mode, std::span<const BiomeColor> colors, std::size_t count) {
	constexpr std::uint8_t min_alpha = 128;
	std::vector<std::uint8_t> result(static_cast<std::size_t>(pixels.size.x) * static_cast<std::size_t>(pixels.size.y));
	const std::uint8_t *pixel = pixels.bytes.ptr();
	const std::uint8_t *previous_pixel = nullptr;
	std::uint8_t previous_biome = no_biome;
	for (std::uint8_t &biome : result) {
		if (mode == BiomePixels::indices) {
			biome = *pixel < count ? *pixel : no_biome;
		} else if (previous_pixel != nullptr && std::equal(pixel, pixel + 4, previous_pixel)) {
			// Adjacent pixels usually have the same color, so the previous result is reused.
			biome = previous_biome;
		} else {
			biome = pixel[3] < min_alpha ? no_biome : nearest_biome(pixel, colors);
			previous_pixel = pixel;
			previous_biome = biome;
		}
		pixel += 4;
	}
	return result;
}

} // namespace thicket
