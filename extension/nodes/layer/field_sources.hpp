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

/// What a worker may ask of the engine's resources: copies and tables that nobody changes any more. Made on the main thread.

/// Stretches of a curve between which its table is exact; within them it is a straight line.
inline constexpr std::size_t curve_stretches = 512;

/// A curve over its own domain, held to 0 to 1. Null for none, for one without points, and for an empty domain.
std::shared_ptr<const CurveTable> curve_table(const godot::Ref<godot::Curve> &p_curve);

/// The colors of a gradient from its start to its end, in equal steps. Null for none.
std::shared_ptr<const ColorTable> color_table(const godot::Ref<godot::Gradient> &p_gradient);

/// A copy that nobody else has, so that it does not matter what happens to the noise afterwards. Null for no noise.
godot::Ref<godot::Noise> noise_copy(const godot::Ref<godot::Noise> &p_noise);

/// The noise at a position as a density: `curve` at its value, or 0.5 + 0.5 times its value where that is null. Nobody may change
/// the noise any more; see `noise_copy`. Null for no noise.
std::shared_ptr<const DensityField> noise_field(
		const godot::Ref<godot::Noise> &p_noise, std::shared_ptr<const CurveTable> curve);

/// A copy of the noise as a density, 0.5 + 0.5 times its value. Null for no noise.
std::shared_ptr<const DensityField> plain_noise_field(const godot::Ref<godot::Noise> &p_noise);

/// What of an image's pixels is a density. The values are those that scenes store.
enum class ImageChannel : std::uint8_t { red, green, blue, alpha, luminance };

/// One channel of an image, 0 to 255, row by row.
struct ChannelPixels {
	glm::ivec2 size{0}; ///< 0 where there is no image, or one that cannot be read.
	std::vector<std::uint8_t> values;
};

/// Reads any format that the engine can convert, values held to 0 to 1. Luminance is that of linear Rec. 709 colors; of an
/// image that has red alone, red.
ChannelPixels channel_pixels(const godot::Ref<godot::Image> &p_image, ImageChannel channel);

} // namespace thicket
