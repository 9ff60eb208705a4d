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

/// Writes four numbers, rounded, and returns what of `r_floats` comes after them.
std::span<float> write_four(std::initializer_list<float> values, std::span<float> r_floats) {
	std::transform(values.begin(), values.end(), r_floats.begin(), rounded_to_half);
	return r_floats.subspan(values.size());
}

/// All of a word as a float from 0 to 1.
float unit_float(std::uint32_t word) { return static_cast<float>(unit_interval(word)); }

} // namespace

Status validate(const InstanceData &data) {
	if (data.colors == nullptr) {
		return {};
	}
	const auto count = static_cast<double>(data.colors->size());
	Status status = check_range("colors", count, 1.0, double{max_colors});
	for (std::size_t i = 0; status.ok() && i < data.colors->size(); ++i) {
		for (int channel = 0; status.ok() && channel < 4; ++channel) {
			status = check_range("colors", double{(*data.colors)[i][channel]}, 0.0, double{max_color});
		}
	}
	return status;
}

void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats) {
	if (!data.use_colors && !data.use_custom_data) {
		return;
	}
	const auto random = instance_random(seed, id, Draw::mesh);
	if (data.use_colors) {
		glm::vec4 color(1.0f);
		if (data.colors != nullptr) {
			color = (*data.colors)[static_cast<std::size_t>(random[3] * std::uint64_t{data.colors->size()} >> 32)];
		}
		r_floats = write_four({color.r, color.g, color.b, color.a}, r_floats);
	}
	if (data.use_custom_data) {
		write_four({unit_float(random[1]), unit_float(random[2]), unit_float(rank), scale}, r_floats);
	}
}

float rounded_to_half(float value) {
	// Adding and taking away a number whose last bit is worth as much as a half's last bit rounds to that bit, ties to
	// even: 2^13 times the power of two below |value|, and at least as much as for the smallest normal half, 2^-14.
	constexpr std::uint32_t exponent_bits = 0x7f800000;
	const float power = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & exponent_bits);
	const float magic = std::max(power, 0x1p-14f) * 0x1.8p13f;
	return (value + magic) - magic;
}

} // namespace thicket
