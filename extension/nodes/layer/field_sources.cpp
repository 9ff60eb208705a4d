#include "nodes/layer/field_sources.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/color.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <algorithm>
#include <array>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr std::size_t gradient_colors = 256;

// Image formats of Godot 4.6 and later, as numbers, because older headers lack the names. Tests
// compare the numbers with those of newer engines.
constexpr auto format_r16 = static_cast<Image::Format>(39);
constexpr auto format_r16i = static_cast<Image::Format>(43);

/// Noise that any thread can sample. Sampling does not modify the object, and nothing else does.
class NoiseField final : public DensityField {
public:
	NoiseField(Ref<Noise> p_noise, std::shared_ptr<const CurveTable> curve) :
			noise_(std::move(p_noise)), curve_(std::move(curve)) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override {
		for (std::size_t i = 0; i < positions.size(); ++i) {
			const auto [x, z] = engine_position(positions[i]);
			r_density[i] = density_of(noise_->get_noise_2d(x, z));
		}
		return {};
	}

	Status sample_in_space(std::span<const glm::dvec2> positions, std::span<const float> heights,
			std::span<float> r_density) const override {
		for (std::size_t i = 0; i < positions.size(); ++i) {
			const auto [x, z] = engine_position(positions[i]);
			r_density[i] = density_of(noise_->get_noise_3d(x, heights[i], z));
		}
		return {};
	}

private:
	static std::pair<float, float> engine_position(glm::dvec2 position) {
		return {static_cast<float>(position.x), static_cast<float>(position.y)};
	}

	float density_of(double value) const { return static_cast<float>(curve_ ? curve_->at(value) : 0.5 + 0.5 * value); }

	Ref<Noise> noise_;
	std::shared_ptr<const CurveTable> curve_;
};

/// Clamps a value to 0 to `max`. NAN becomes 0.
float clamped(float value, float max) { return value > 0.0F ? std::min(value, max) : 0.0F; }

bool is_red_format(Image::Format p_format) {
	constexpr std::array formats{Image::FORMAT_R8, Image::FORMAT_RF, Image::FORMAT_RH, format_r16, format_r16i,
			Image::FORMAT_RGTC_R, Image::FORMAT_ETC2_R11, Image::FORMAT_ETC2_R11S};
	return std::find(formats.begin(), formats.end(), p_format) != formats.end();
}

std::uint8_t luminance(const std::uint8_t *rgba) {
	constexpr double red = 0.2126;
	constexpr double green = 0.7152;
	constexpr double blue = 0.0722;
	return static_cast<std::uint8_t>(red * rgba[0] + green * rgba[1] + blue * rgba[2] + 0.5);
}

} // namespace

std::shared_ptr<const CurveTable> curve_table(const Ref<Curve> &p_curve) {
	if (p_curve.is_null() || p_curve->get_point_count() == 0) {
		return nullptr;
	}
	const double min = p_curve->get_min_domain();
	const double max = p_curve->get_max_domain();
	std::array<float, curve_segments + 1> samples{};
	for (std::size_t i = 0; i < samples.size(); ++i) {
		const double fraction = static_cast<double>(i) / static_cast<double>(curve_segments);
		// The last sample is exactly at the end of the domain, without rounding error.
		const double offset = i == curve_segments ? max : min + fraction * (max - min);
		samples[i] = clamped(static_cast<float>(p_curve->sample(static_cast<float>(offset))), 1.0F);
	}
	const auto table = std::make_shared<CurveTable>();
	return table->set(min, max, samples).ok() ? table : nullptr;
}

std::shared_ptr<const ColorTable> color_table(const Ref<Gradient> &p_gradient) {
	if (p_gradient.is_null()) {
		return nullptr;
	}
	const auto table = std::make_shared<ColorTable>();
	for (std::size_t i = 0; i < gradient_colors; ++i) {
		const double offset = (static_cast<double>(i) + 0.5) / static_cast<double>(gradient_colors);
		const Color color = p_gradient->sample(static_cast<float>(offset));
		table->emplace_back(clamped(color.r, max_color), clamped(color.g, max_color), clamped(color.b, max_color),
				clamped(color.a, 1.0F));
	}
	return table;
}

Ref<Noise> noise_copy(const Ref<Noise> &p_noise) {
	return p_noise.is_valid() ? p_noise->duplicate(true) : Ref<Resource>();
}

std::shared_ptr<const DensityField> noise_field(const Ref<Noise> &p_noise, std::shared_ptr<const CurveTable> curve) {
	return p_noise.is_valid() ? std::make_shared<NoiseField>(p_noise, std::move(curve)) : nullptr;
}

std::shared_ptr<const DensityField> plain_noise_field(const Ref<Noise> &p_noise) {
	return noise_field(noise_copy(p_noise), nullptr);
}

ChannelPixels channel_pixels(const Ref<Image> &p_image, ImageChannel channel) {
	ChannelPixels result;
	if (p_image.is_null() || p_image->get_width() <= 0 || p_image->get_height() <= 0) {
		return result;
	}
	const bool has_only_red = is_red_format(p_image->get_format());
	const Ref<Image> image = p_image->duplicate();
	if (image->is_compressed() && image->decompress() != OK) {
		return result;
	}
	image->clear_mipmaps();
	image->convert(Image::FORMAT_RGBA8);
	const PackedByteArray bytes = image->get_data();
	result.size = {image->get_width(), image->get_height()};
	result.values.resize(static_cast<std::size_t>(result.size.x) * static_cast<std::size_t>(result.size.y));
	if (bytes.size() != 4 * static_cast<int64_t>(result.values.size())) {
		return {};
	}
	const bool gray = channel == ImageChannel::luminance && !has_only_red;
	const std::size_t offset = channel == ImageChannel::luminance ? 0 : static_cast<std::size_t>(channel);
	const std::uint8_t *pixel = bytes.ptr();
	for (std::uint8_t &value : result.values) {
		value = gray ? luminance(pixel) : pixel[offset];
		pixel += 4;
	}
	return result;
}

} // namespace thicket
