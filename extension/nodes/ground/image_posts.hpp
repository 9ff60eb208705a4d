#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/status.hpp"
#include "core/heightmap/posts.hpp"
#include "core/terrain/weight_map.hpp"

#include <godot_cpp/classes/image.hpp>

namespace thicket {

/// Returns the image of an Image or a Texture2D. Returns null for null, for resources of other
/// classes, and if the texture has no image yet.
godot::Ref<godot::Image> image_of(const godot::Ref<godot::Resource> &p_resource);

/// Returns true if the image is not null and has pixels.
bool has_content(const godot::Ref<godot::Image> &p_image);

/// Reads the first channel of an image, as floats from float formats and as 16-bit integers from
/// all others. Errors name `p_property`.
Status read_posts(const godot::Ref<godot::Image> &p_image, const char *p_property, Posts &r_posts);

/// Reads the height samples of a rectangle that lies within an image. Does not convert the rest of
/// the image, so a small rectangle is cheap. Returns false for compressed and unknown formats.
bool read_region(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, Posts &r_posts);

/// Reads all channels of an image as texture weights, one texture per channel. Errors name
/// `p_property`.
Status read_weights(const godot::Ref<godot::Image> &p_image, const char *p_property, WeightMap &r_weights);

} // namespace thicket
