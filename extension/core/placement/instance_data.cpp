#include "core/placement/instance_data.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/rules/instance_random.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>

namespace thicket {

namespace {

/// Writes four numbers, rounded to half floats, and returns the remaining part of `r_floats`.
std::span<float> write_four(std::initializer_list<float> values, std::span<float> r_floats) {
	std::transform(values.begin(), values.end(), r_floats.begin(), rounded_to_half);
	return r_floats.subspan(values.size());
}

/// Converts all bits of a word to a float from 0 to 1.
float unit_float(std::uint32_t word) { return static_cast<float>(unit_interval(word)); }

glm::vec4 color_of(const InstanceData &data, float fraction, std::uint32_t word) {
	if (data.colors == nullptr) {
		return glm::vec4(1.0f);
	}
	const ColorTable &colors = *data.colors;
	if (fraction < 0.0f && data.color.curve == nullptr) {
		return colors[static_cast<std::size_t>(word * std::uint64_t{colors.size()} >> 32)];
	}
	const double along = mixed(data.color, fraction, unit_interval(word)) * static_cast<double>(colors.size());
	return colors[std::min(static_cast<std::size_t>(along), colors.size() - 1)];
}

Status validate_colors(const ColorTable &colors) {
	const auto count = static_cast<double>(colors.size());
	Status status = check_range("colors", count, 1.0, double{max_colors});
	for (std::size_t i = 0; status.ok() && i < colors.size(); ++i) {
		for (int channel = 0; status.ok() && channel < 4; ++channel) {
			status = check_range("colors", double{colors[i][channel]}, 0.0, double{max_color});
		}
	}
	return status;
}

} // namespace

Status validate(const InstanceData &data) {
	constexpr SourceNames color{"color_value.min_value", "color_value.max_value", "color_value.randomness"};
	constexpr SourceNames variation{
			"variation_value.min_value", "variation_value.max_value", "variation_value.randomness"};
	constexpr SourceNames scale{"scale_value.min_value", "scale_value.max_value", "scale_value.randomness"};
	return first_failure(validate(data.scale, scale), data.colors != nullptr ? validate_colors(*data.colors) : Status{},
			data.use_colors ? validate(data.color, color) : Status{},
			data.use_custom_data ? validate(data.variation, variation) : Status{});
}

std::array<const InstanceSource *, 3> distance_sources(const InstanceData &data) {
	const auto known_source = [](const InstanceSource &source, bool known) {
		return known && source.kind == SourceKind::distance ? &source : nullptr;
	};
	return {known_source(data.scale, data.scale_is_known()), known_source(data.color, data.color_is_known()),
			known_source(data.variation, data.variation_is_known())};
}

SourceFractions fractions_by_hand(
		const InstanceData &data, glm::dvec3 position, bool on_surface, const Planet &planet) {
	SourceFractions fractions;
	if (data.color_is_known()) {
		fractions.color = fraction_by_hand(data.color, position, on_surface, planet);
	}
	if (data.variation_is_known()) {
		fractions.variation = fraction_by_hand(data.variation, position, on_surface, planet);
	}
	return fractions;
}

void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats, const SourceFractions &fractions) {
	if (!data.use_colors && !data.use_custom_data) {
		// There is nothing to write, so no random numbers are needed.
		return;
	}
	const auto random = instance_random(seed, id, Draw::mesh);
	if (data.use_colors) {
		const glm::vec4 color = color_of(data, fractions.color, random[3]);
		r_floats = write_four({color.r, color.g, color.b, color.a}, r_floats);
	}
	if (data.use_custom_data) {
		const double variation = mixed(data.variation, fractions.variation, unit_interval(random[1]));
		write_four({static_cast<float>(variation), unit_float(random[2]), unit_float(rank), scale}, r_floats);
	}
}

double scale_number(const ScaleSource &source, std::uint64_t seed, std::uint64_t id, float fraction) {
	return mixed(source, fraction, unit_interval(instance_random(seed, id, Draw::placement)[1]));
}

float rounded_to_half(float value) {
	// Adding and subtracting a number whose last bit has the value of a half float's last bit
	// rounds `value` to that bit, ties to even. The number's exponent is that of |value|, but at
	// least that of the smallest normal half float, 2^-14.
	constexpr std::uint32_t exponent_bits = 0x7f800000;
	const float power = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & exponent_bits);
	const float magic = std::max(power, 0x1p-14f) * 0x1.8p13f;
	return (value + magic) - magic;
}

} // namespace thicket
