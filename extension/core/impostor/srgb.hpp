#pragma once

#include <array>
#include <cstdint>

namespace thicket {

/// The curve of sRGB (IEC 61966-2-1) for bytes, with the same bits on every machine: the C library's powers round as they like.
class SrgbCurve {
public:
	/// The one that is there, made at the first call.
	static const SrgbCurve &get();

	/// The linear value of a stored byte, 0 to 1; within 1e-6 of the exact value.
	float linear(std::uint8_t stored) const { return linear_[stored]; }

	/// The linear value of any stored value; 0 below 0 and 1 above 1, and for NAN 0.
	float linear(float stored) const;

	/// The byte whose linear value is nearest; 0 for NAN.
	std::uint8_t stored(float linear) const;

private:
	SrgbCurve();

	std::array<float, 256> linear_{};
};

/// The byte of a value in [0, 1], by rounding; what is outside is clamped, and NAN is 0.
std::uint8_t unit_byte(float value);

} // namespace thicket
