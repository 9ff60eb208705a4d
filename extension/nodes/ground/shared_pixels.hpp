#pragma once

#include "core/terrain/pixel_grid.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Returns the Image in a Variant. Returns null for other values, and for an image without pixels.
godot::Ref<godot::Image> image_in(const godot::Variant &p_value);

/// Shares the pixels of an image of any size without copying them (copy-on-write). Returns false if
/// the image has a different number of bytes per pixel.
bool share_pixels(const godot::Ref<godot::Image> &p_image, int pixel_bytes, PixelGrid &r_pixels);

/// Shares pixels like `share_pixels`, but converts a copy if the image has another format. Returns
/// false if the engine cannot convert the image.
bool share_pixels_as(
		const godot::Ref<godot::Image> &p_image, godot::Image::Format format, int pixel_bytes, PixelGrid &r_pixels);

/// Copies a part of an image into `r_pixels`, which then no longer shares memory with any image.
/// Returns false if the image has another size or fewer bytes per pixel, or if the part is empty or
/// not inside the image.
bool patch_pixels(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, PixelGrid &r_pixels);

} // namespace thicket
