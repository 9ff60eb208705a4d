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

/// How a mask texture is laid over the world.
struct MaskFrame {
	Rect area{{0.0, 0.0}, {1000.0, 1000.0}}; ///< Meters.
	ImageChannel channel = ImageChannel::red;
	MaskEdge edge = MaskEdge::nothing;
};

/// A texture whose pixels are asked of the renderer, which waits for it, only where they may be others.
struct TextureSource {
	godot::Ref<godot::Texture2D> texture;
	bool unread = false;
};

/// Takes over what was made anew of a resource. A table that says the same stays the same object, so that settings may compare
/// tables by pointer: another pointer means that tiles are made anew.
template <class Made>
void replace(Made &r_old, Made fresh) {
	r_old = std::move(fresh);
}

template <std::equality_comparable Table>
void replace(std::shared_ptr<const Table> &r_old, std::shared_ptr<const Table> fresh) {
	if (r_old != nullptr && fresh != nullptr && *r_old == *fresh) {
		// Fast path: for the same table no tile has to be made anew.
		return;
	}
	r_old = std::move(fresh);
}

/// What is made of a resource and other properties together: noise with its curve, a texture with its frame, and a line in
/// place of a proximity curve. Tables of all other resources go straight to the settings.
class LayerTables {
public:
	/// Brings what is made up to date with the sources and with the properties.
	void refresh(const MaskFrame &frame, double proximity_distance);

	// Sources, each made of one resource.
	std::shared_ptr<const CurveTable> noise_curve;
	godot::Ref<godot::Noise> noise_source; ///< A copy. Noise cannot be compared: another object means another noise.
	TextureSource mask_texture;
	godot::Ref<godot::Image> mask_texture_image; ///< Used where the texture has none.

	// What is made of them.
	std::shared_ptr<const DensityField> noise;
	std::shared_ptr<const ImageMask> image;           ///< All 0 while a texture has no image.
	std::shared_ptr<const CurveTable> proximity_line; ///< Never null after `refresh`.
	Status image_status;        ///< What is wrong with the texture's image; the last good mask is kept.
	bool image_missing = false; ///< There is a texture, but no image in it, or none that can be read.

private:
	void refresh_noise();
	void refresh_image(const MaskFrame &frame);

	std::shared_ptr<const CurveTable> used_curve_; ///< Of which `noise` was made.
	godot::Ref<godot::Noise> used_source_;         ///< Of which `noise` was made.
	ChannelPixels pixels_;
	MaskFrame frame_; ///< As `pixels_` and `image` were made.
};

} // namespace thicket
