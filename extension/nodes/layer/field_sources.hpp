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

// These functions copy resources for workers, which must not use the engine's resources. Call them
// on the main thread. Their results never change.

/// The number of segments in a curve's table. Values are exact at the ends of each segment and
/// linearly interpolated in between.
inline constexpr std::size_t curve_segments = 512;

/// Samples a curve over its domain and clamps the values to the range 0 to 1. Returns null if the
/// curve is null or has no points, or if its domain is empty.
std::shared_ptr<const CurveTable> curve_table(const godot::Ref<godot::Curve> &p_curve);

/// Samples the colors of a gradient from its start to its end in equal steps. Returns null for a
/// null gradient.
std::shared_ptr<const ColorTable> color_table(const godot::Ref<godot::Gradient> &p_gradient);

/// Returns a copy that later changes to the noise do not affect. Returns null for null.
godot::Ref<godot::Noise> noise_copy(const godot::Ref<godot::Noise> &p_noise);

/// Returns a density field: `curve` at the noise value, or 0.5 + 0.5 * value if `curve` is null.
/// The noise must never change again (see `noise_copy`). Returns null for null noise.
std::shared_ptr<const DensityField> noise_field(
		const godot::Ref<godot::Noise> &p_noise, std::shared_ptr<const CurveTable> curve);

/// Copies the noise and returns it as a density field: 0.5 + 0.5 * value. Returns null for null
/// noise.
std::shared_ptr<const DensityField> plain_noise_field(const godot::Ref<godot::Noise> &p_noise);

/// The channel of an image to use as a density. Scenes store these values, so they must not change.
enum class ImageChannel : std::uint8_t { red, green, blue, alpha, luminance, none };

/// One channel of an image, 0 to 255, row by row.
struct ChannelPixels {
	glm::ivec2 size{0}; ///< The size in pixels; 0 if the image is missing or cannot be read.
	std::vector<std::uint8_t> values;
};

/// Reads one channel of an image in any format that the engine can convert. Clamps values to the
/// range 0 to 1 before they are scaled to 0 to 255. Luminance is the Rec. 709 luminance of the
/// channels, which are assumed to be linear. For an image with only a red channel, luminance is the
/// red value.
ChannelPixels channel_pixels(const godot::Ref<godot::Image> &p_image, ImageChannel channel);

} // namespace thicket
