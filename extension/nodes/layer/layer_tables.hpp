#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "nodes/layer/field_sources.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/texture2d.hpp>

#include <concepts>
#include <memory>
#include <utility>

namespace thicket {

/// Maps a mask texture to the world.
struct MaskFrame {
	Rect area{{0.0, 0.0}, {1000.0, 1000.0}}; ///< Meters.
	ImageChannel channel = ImageChannel::red;
	MaskEdge edge = MaskEdge::nothing;
};

/// A texture, and a flag for pixels that may have changed. Pixels are read back only if it is set, because reading
/// waits for the renderer.
struct TextureSource {
	godot::Ref<godot::Texture2D> texture;
	bool unread = false;
};

/// Replaces a table that was rebuilt from a resource. If the new table is equal, keeps the old object: settings compare
/// tables by pointer, and a different pointer regenerates tiles.
template <class Made>
void replace(Made &r_old, Made fresh) {
	r_old = std::move(fresh);
}

template <std::equality_comparable Table>
void replace(std::shared_ptr<const Table> &r_old, std::shared_ptr<const Table> fresh) {
	if (r_old != nullptr && fresh != nullptr && *r_old == *fresh) {
		// An equal table regenerates no tile.
		return;
	}
	r_old = std::move(fresh);
}

/// The data that depends on a resource together with other properties: a noise with its curve, a texture with its
/// frame, and a line that replaces a missing proximity curve. Tables of all other resources are stored directly in the
/// settings.
class LayerTables {
public:
	/// Updates the results to match the sources and the properties.
	void refresh(const MaskFrame &frame, double proximity_distance);

	// Sources, each created from one resource.
	std::shared_ptr<const CurveTable> noise_curve;
	godot::Ref<godot::Noise> noise_source; ///< A copy. Noise cannot be compared, only its objects can.
	TextureSource mask_texture;
	godot::Ref<godot::Image> mask_texture_image; ///< Used if the texture has no image.

	// Results, created from the sources.
	std::shared_ptr<const DensityField> noise;
	std::shared_ptr<const ImageMask> image;           ///< All 0 while a texture has no image.
	std::shared_ptr<const CurveTable> proximity_line; ///< Never null after `refresh`.
	Status image_status;                              ///< The error of the texture's image; the last good mask is kept.
	bool image_missing = false; ///< True if there is a texture, but its image is missing or cannot be read.

private:
	void refresh_noise();
	void refresh_image(const MaskFrame &frame);

	std::shared_ptr<const CurveTable> used_curve_; ///< The curve that `noise` uses.
	godot::Ref<godot::Noise> used_source_;         ///< The noise that `noise` uses.
	ChannelPixels pixels_;
	MaskFrame frame_; ///< The frame with which `pixels_` and `image` were created.
};

} // namespace thicket
