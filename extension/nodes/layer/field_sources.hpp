#pragma once

#include "core/placement/instance_data.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/image_mask.hpp"

#include <godot_cpp/classes/curve.hpp>
#include <godot_cpp/classes/gradient.hpp>
#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/noise.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Copies and tables for workers, which must not use the engine's resources. They are created on the main thread and
/// never change afterwards.

/// The number of segments in a curve's table. Exact at the ends of each segment, linear in between.
inline constexpr std::size_t curve_stretches = 512;

/// Samples a curve over its own domain, with values clamped to 0 to 1. Null if there is no curve, if it has no points, or if its domain is
/// empty.
std::shared_ptr<const CurveTable> curve_table(const godot::Ref<godot::Curve> &p_curve);

/// The colors of a gradient from its start to its end, in equal steps. Null if there is no gradient.
std::shared_ptr<const ColorTable> color_table(const godot::Ref<godot::Gradient> &p_gradient);

/// A private copy, so that later changes of the noise do not affect it. Null if there is no noise.
godot::Ref<godot::Noise> noise_copy(const godot::Ref<godot::Noise> &p_noise);

/// The noise at a position as a density: `curve` at the noise value, or 0.5 + 0.5 times the value if `curve` is null.
/// The noise must never change again; see `noise_copy`. Null if there is no noise.
std::shared_ptr<const DensityField> noise_field(
		const godot::Ref<godot::Noise> &p_noise, std::shared_ptr<const CurveTable> curve);

/// A copy of the noise as a density: 0.5 + 0.5 times the noise value. Null if there is no noise.
std::shared_ptr<const DensityField> plain_noise_field(const godot::Ref<godot::Noise> &p_noise);

/// The channel of an image that is used as a density. Scenes store these values.
enum class ImageChannel : std::uint8_t { red, green, blue, alpha, luminance };

/// One channel of an image, 0 to 255, row by row.
struct ChannelPixels {
	glm::ivec2 size{0}; ///< 0 if there is no image, or it cannot be read.
	std::vector<std::uint8_t> values;
};

/// Reads any format that the engine can convert, and clamps values to 0 to 1. Luminance is computed from linear Rec.
/// 709 colors; for an image with only a red channel, it is the red value.
ChannelPixels channel_pixels(const godot::Ref<godot::Image> &p_image, ImageChannel channel);

} // namespace thicket
