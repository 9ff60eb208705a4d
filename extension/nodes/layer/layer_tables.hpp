#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "nodes/layer/field_sources.hpp"

#include <godot_cpp/classes/texture2d.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace thicket {

/// The resources of the engine that a layer's settings are made of. Null where there is none.
struct LayerResources {
	godot::Ref<godot::Curve> density_over_height;
	godot::Ref<godot::Curve> density_over_slope;
	godot::Ref<godot::Noise> noise;
	godot::Ref<godot::Curve> noise_curve;
	godot::Ref<godot::Texture2D> mask_texture;
	godot::Ref<godot::Curve> proximity_curve;
	godot::Ref<godot::Curve> scale_curve;
	godot::Ref<godot::Gradient> color_gradient;
};

/// Each of them by its number.
enum class LayerSource : std::uint8_t {
	density_over_height,
	density_over_slope,
	noise,
	noise_curve,
	mask_texture,
	proximity_curve,
	scale_curve,
	color_gradient,
	count,
};

/// How a mask texture is laid over the world.
struct MaskFrame {
	Rect area{{0.0, 0.0}, {1000.0, 1000.0}}; ///< Meters.
	ImageChannel channel = ImageChannel::red;
	MaskEdge edge = MaskEdge::nothing;
};

/// The tables, fields and masks that workers use, made of a layer's resources. Each stays the same object while its content is the
/// same, so settings may compare them by pointer: another pointer means that tiles are made anew.
class LayerTables {
public:
	/// Says that a resource, or what is in it, may have changed.
	void mark(LayerSource source) { marked_[static_cast<std::size_t>(source)] = true; }

	/// Brings all that was marked up to date.
	void refresh(const LayerResources &resources, const MaskFrame &frame, double proximity_distance);

	std::shared_ptr<const CurveTable> height_curve;
	std::shared_ptr<const CurveTable> slope_curve;
	std::shared_ptr<const CurveTable> scale_curve;
	std::shared_ptr<const CurveTable> noise_curve;         ///< As `noise` has it.
	std::shared_ptr<const CurveTable> own_proximity_curve; ///< The designer's.
	std::shared_ptr<const CurveTable> proximity_curve;     ///< That, or a straight line; never null after `refresh`.
	std::shared_ptr<const DensityField> noise;
	std::shared_ptr<const ImageMask> image; ///< All 0 while a texture has no image.
	std::shared_ptr<const ColorTable> colors;

	Status image_status;        ///< What is wrong with the texture's image; the last good mask is kept.
	bool image_missing = false; ///< There is a texture, but no image in it, or none that can be read.

private:
	bool take(LayerSource source);
	void refresh_curve(
			LayerSource source, const godot::Ref<godot::Curve> &p_curve, std::shared_ptr<const CurveTable> &r_table);
	void refresh_noise(const LayerResources &resources);
	void refresh_proximity(const LayerResources &resources, double distance);
	void refresh_image(const godot::Ref<godot::Texture2D> &p_texture, const MaskFrame &frame);

	std::array<bool, static_cast<std::size_t>(LayerSource::count)> marked_{};
	ChannelPixels pixels_;
	MaskFrame frame_; ///< As `pixels_` and `image` were made.
};

} // namespace thicket
