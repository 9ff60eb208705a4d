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

/// Values on a grid, row by row, x fastest: 16-bit integers, or floats as they were found.
struct Posts {
	glm::ivec2 count{0};
	std::vector<std::uint16_t> steps; ///< Empty if there are floats.
	std::vector<float> floats;
};

/// The image of an Image or of a Texture2D. Null for null, for any other resource, and for a texture without an image yet.
godot::Ref<godot::Image> image_of(const godot::Ref<godot::Resource> &p_resource);

/// True for an image with pixels.
bool has_content(const godot::Ref<godot::Image> &p_image);

/// The first channel of an image: floats for formats that store floats, 16 bits for all others. Errors name `p_property`.
Status read_posts(const godot::Ref<godot::Image> &p_image, const char *p_property, Posts &r_posts);

/// Reads the posts of a rectangle within an image; cheap for a small one. False for formats that are compressed, and for those that this
/// function does not know.
bool read_region(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, Posts &r_posts);

/// `p_count` posts from a file's bytes: one byte each for 8 bits, two for 16 bits, four for floats, all little-endian. Errors name
/// `p_property`.
Status read_posts(const godot::PackedByteArray &p_bytes, glm::ivec2 p_count, const char *p_property, Posts &r_posts);

/// All channels of the image's format, as the weights of as many textures. Errors name `p_property`.
Status read_weights(const godot::Ref<godot::Image> &p_image, const char *p_property, WeightMap &r_weights);

} // namespace thicket
