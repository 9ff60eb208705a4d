#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace thicket {

/// The storage format of the samples of a height map. Floats have the byte order of the machine.
enum class PostFormat : std::uint8_t {
	float32, ///< Heights in meters as 32-bit floats.
	float16, ///< Heights in meters as 16-bit floats (IEEE 754 binary16).
	rgb8,    ///< HTerrain's format: (r + 256 g + 65536 b) / 1024 - 8192 meters (hterrain_data.gd).
};

constexpr int bytes_of(PostFormat format) {
	return format == PostFormat::float32 ? 4 : format == PostFormat::float16 ? 2 : 3;
}

/// Converts IEEE 754 binary16 to float exactly.
constexpr float half_to_float(std::uint16_t half) {
	const bool negative = (half & 0x8000u) != 0;
	const unsigned exponent = half >> 10u & 0x1fu;
	const unsigned fraction = half & 0x3ffu;
	float value = 0.0F;
	if (exponent == 0) {
		value = static_cast<float>(fraction) * 0x1p-24F;
	} else if (exponent == 0x1f) {
		value = fraction != 0 ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
	} else {
		value = std::bit_cast<float>((exponent + 112u) << 23u | fraction << 13u);
	}
	return negative ? -value : value;
}

/// Reads a height sample, in meters, from its bytes_of(format) bytes.
inline double post_height(const std::uint8_t *bytes, PostFormat format) {
	switch (format) {
		case PostFormat::float32: {
			float height = 0.0F;
			std::memcpy(&height, bytes, sizeof(height));
			return height;
		}
		case PostFormat::float16: {
			std::uint16_t half = 0;
			std::memcpy(&half, bytes, sizeof(half));
			return half_to_float(half);
		}
		case PostFormat::rgb8: return (bytes[0] + 256.0 * bytes[1] + 65536.0 * bytes[2]) / 1024.0 - 8192.0;
	}
	return std::numeric_limits<double>::quiet_NaN();
}

} // namespace thicket
