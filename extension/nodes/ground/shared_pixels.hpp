#pragma once

#include "core/terrain/pixel_grid.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// The image in a variant; null for anything else, and for an image without pixels.
godot::Ref<godot::Image> image_in(const godot::Variant &p_value);

/// Shares the pixels of an image of any size without copying them; the first writer copies them. Returns false for
/// an image with a different number of bytes per pixel.
bool share_pixels(const godot::Ref<godot::Image> &p_image, int pixel_bytes, PixelGrid &r_pixels);

/// Shares the pixels of an image of any format. If the format differs, converts and copies them. Returns false if the
/// engine cannot convert them.
bool share_pixels_as(
		const godot::Ref<godot::Image> &p_image, godot::Image::Format format, int pixel_bytes, PixelGrid &r_pixels);

/// Copies a part of an image into pixels of the same size that were shared with it, and ends the sharing. Returns false
/// for an image of a different size or with fewer bytes per pixel, and for a part that is empty or not inside the
/// image.
bool patch_pixels(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, PixelGrid &r_pixels);

} // namespace thicket
