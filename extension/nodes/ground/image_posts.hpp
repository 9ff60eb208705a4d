#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/status.hpp"
#include "core/terrain/weight_map.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// Values on a grid, row by row, x fastest: 16-bit integers, or floats as in the source.
struct Posts {
	glm::ivec2 count{0};
	std::vector<std::uint16_t> steps; ///< Empty if there are floats.
	std::vector<float> floats;
};

/// The image in an Image or a Texture2D. Null if the resource is null or of a different class, or if the texture has no
/// image yet.
godot::Ref<godot::Image> image_of(const godot::Ref<godot::Resource> &p_resource);

/// True for an image with pixels.
bool has_content(const godot::Ref<godot::Image> &p_image);

/// Reads the first channel of an image: as floats from formats that store floats, as 16 bits from all others. Errors
/// name `p_property`.
Status read_posts(const godot::Ref<godot::Image> &p_image, const char *p_property, Posts &r_posts);

/// Reads the posts of a rectangle within an image, which is cheap for a small rectangle. Returns false for compressed
/// and unknown formats.
bool read_region(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, Posts &r_posts);

/// Reads `p_count` posts from a file's bytes, little-endian: one byte each for 8 bits, two for 16 bits, four for
/// floats. Errors name `p_property`.
Status read_posts(const godot::PackedByteArray &p_bytes, glm::ivec2 p_count, const char *p_property, Posts &r_posts);

/// Reads all channels of the image's format; each channel has the weights of one texture. Errors name `p_property`.
Status read_weights(const godot::Ref<godot::Image> &p_image, const char *p_property, WeightMap &r_weights);

} // namespace thicket
