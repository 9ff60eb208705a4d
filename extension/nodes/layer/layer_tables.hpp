#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/rules/world_input.hpp"
#include "nodes/layer/field_sources.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/texture2d.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <utility>

namespace thicket {

/// The settings that map a mask texture to the world.
struct MaskFrame {
	Rect area{{0.0, 0.0}, {1000.0, 1000.0}}; ///< The area that the texture covers, in world meters.
	ImageChannel channel = ImageChannel::red;
	MaskEdge edge = MaskEdge::nothing;
};

/// A texture, and a flag that is set when its pixels may have changed. Pixels are read only if the
/// flag is set, because reading waits for the renderer.
struct TextureSource {
	godot::Ref<godot::Texture2D> texture;
	bool must_read = false;
};

/// Replaces a table after it was rebuilt from a resource. If the new table is equal, keeps the old
/// object: settings compare tables by pointer, so a new pointer would regenerate tiles.
template <class Value>
void replace(Value &r_old, Value new_value) {
	r_old = std::move(new_value);
}

template <std::equality_comparable Table>
void replace(std::shared_ptr<const Table> &r_old, std::shared_ptr<const Table> new_table) {
	if (r_old != nullptr && new_table != nullptr && *r_old == *new_table) {
		return;
	}
	r_old = std::move(new_table);
}

/// The tables that depend on several properties: noise with its curve, a texture with its frame,
/// and the line that replaces a missing proximity curve. LayerSettings contains the tables that
/// depend on one resource only.
class LayerTables {
public:
	/// Updates the results to match the sources and the properties. `used_channels` has the bit of each
	/// channel of the mask texture that an expression uses.
	void refresh(const MaskFrame &frame, std::uint32_t used_channels, double proximity_distance);

	// The sources, each created from one resource.
	std::shared_ptr<const CurveTable> noise_curve;
	/// A copy of the noise. Copies are compared by pointer, because Noise has no other comparison.
	godot::Ref<godot::Noise> noise_source;
	TextureSource mask_texture;
	godot::Ref<godot::Image> mask_texture_image; ///< The image to use if the texture has none.

	// The results, created from the sources.
	std::shared_ptr<const DensityField> noise;
	/// The mask of the texture; 0 everywhere if the texture has no image.
	std::shared_ptr<const ImageMask> image;
	/// The used channels of the texture as inputs of expressions, from red to alpha. Null for a channel
	/// that is not used, or if the texture has no image.
	std::array<std::shared_ptr<const ImageMask>, mask_channel_inputs.size()> channels;
	/// The line that replaces a missing proximity curve. Never null after `refresh`.
	std::shared_ptr<const CurveTable> proximity_line;
	/// The error of the texture's image. After an error, `image` keeps the last valid mask.
	Status image_status;
	/// True if there is a texture whose image is missing or cannot be read.
	bool image_missing = false;

private:
	void refresh_noise();
	void refresh_image(const MaskFrame &frame, bool new_pixels, bool new_area);
	void refresh_channels(const MaskFrame &frame, std::uint32_t used_channels, bool new_pixels, bool new_area);
	ChannelPixels pixels_of(ImageChannel channel) const;

	std::shared_ptr<const CurveTable> used_curve_; ///< The curve that `noise` uses.
	godot::Ref<godot::Noise> used_source_;         ///< The noise that `noise` uses.
	ChannelPixels pixels_;
	std::array<ChannelPixels, mask_channel_inputs.size()> channel_pixels_; ///< The pixels of `channels`.
	MaskFrame frame_; ///< The frame with which `pixels_` and `image` were created.
};

} // namespace thicket
