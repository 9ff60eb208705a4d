#pragma once

#include "core/terrain/pixel_grid.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// The image in a variant; null for anything else, and for one without pixels.
godot::Ref<godot::Image> image_in(const godot::Variant &p_value);

/// The pixels of an image of any size, shared with it and not copied: whichever writes first copies. False for an image whose
/// pixels have another number of bytes.
bool share_pixels(const godot::Ref<godot::Image> &p_image, int pixel_bytes, PixelGrid &r_pixels);

/// The same of an image of any format, turned into another one where it differs; that copies. False if the engine cannot.
bool share_pixels_as(
		const godot::Ref<godot::Image> &p_image, godot::Image::Format format, int pixel_bytes, PixelGrid &r_pixels);

/// Copies a part of an image into pixels of the same size that were shared with it, and shares nothing more. False for an
/// image of another size or with fewer bytes a pixel, and for a part that is empty or not within.
bool patch_pixels(const godot::Ref<godot::Image> &p_image, const PixelRect &rect, PixelGrid &r_pixels);

} // namespace thicket
