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

/// Values on a grid, row by row, x fastest: of 16 bits, or floats as they were found.
struct Posts {
	glm::ivec2 count{0};
	std::vector<std::uint16_t> steps; ///< Empty where there are floats.
	std::vector<float> floats;
};

/// The image of an Image or of a Texture2D; null for a null, for what is neither, and for a texture without an image
/// yet.
godot::Ref<godot::Image> image_of(const godot::Ref<godot::Resource> &p_resource);

/// True for an image with pixels.
bool has_content(const godot::Ref<godot::Image> &p_image);

/// The first channel of an image: floats of formats that hold floats, 16 bits of all others. Errors name `p_property`.
Status read_posts(const godot::Ref<godot::Image> &p_image, const char *p_property, Posts &r_posts);

/// The same of a rectangle within an image; cheap for a small one. False where that cannot be done: for formats that are compressed, and
/// those that this does not know.
bool read_region(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, Posts &r_posts);

/// `p_count` posts from a file's bytes: as many bytes for 8 bits, two each for 16 bits, four each for floats, all
/// little-endian. Errors name `p_property`.
Status read_posts(const godot::PackedByteArray &p_bytes, glm::ivec2 p_count, const char *p_property, Posts &r_posts);

/// All channels that the image's format has, as the weights of as many textures. Errors name `p_property`.
Status read_weights(const godot::Ref<godot::Image> &p_image, const char *p_property, WeightMap &r_weights);

} // namespace thicket
