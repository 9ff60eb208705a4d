#pragma once

#include <array>
#include <cstdint>

namespace thicket {

/// The curve of sRGB (IEC 61966-2-1) for bytes. Has the same bits on every machine, because it does not use the C
/// library's power functions, which round differently.
class SrgbCurve {
public:
	/// The shared instance, created at the first call.
	static const SrgbCurve &get();

	/// The linear value of a stored byte, 0 to 1; within 1e-6 of the exact value.
	float linear(std::uint8_t stored) const { return linear_[stored]; }

	/// The linear value of any stored value: 0 below 0, 1 above 1, and 0 for NAN.
	float linear(float stored) const;

	/// The byte whose linear value is nearest; 0 for NAN.
	std::uint8_t stored(float linear) const;

private:
	SrgbCurve();

	std::array<float, 256> linear_{};
};

/// The byte for a value in [0, 1], rounded. Values outside are clamped, and NAN returns 0.
std::uint8_t unit_byte(float value);

} // namespace thicket
