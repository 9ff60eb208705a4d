#pragma once

#include <array>
#include <cstdint>

namespace thicket {

/// The sRGB transfer curve (IEC 61966-2-1) for bytes. Results are bit-identical on every machine,
/// because it avoids the C library's power functions, whose rounding differs between machines.
class SrgbCurve {
public:
	/// Returns the shared instance, which the first call creates. Any thread may call it.
	static const SrgbCurve &get();

	/// Converts an sRGB byte to a linear value, 0 to 1, within 1e-6 of the true value.
	float linear(std::uint8_t encoded) const { return linear_[encoded]; }

	/// Converts an sRGB value to a linear value. Values are clamped to 0 to 1, and NAN returns 0.
	float linear(float encoded) const;

	/// Returns the byte whose linear value is nearest, or 0 for NAN.
	std::uint8_t encoded(float linear) const;

private:
	SrgbCurve();

	std::array<float, 256> linear_{};
};

/// Converts a value in [0, 1] to the nearest byte. Values outside are clamped, and NAN returns 0.
std::uint8_t unit_byte(float value);

} // namespace thicket
