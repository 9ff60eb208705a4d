#include "core/impostor/srgb.hpp"

#include <algorithm>
#include <cstddef>

namespace thicket {

namespace {

/// Returns the fifth root of a number in (0, 1], by Newton's method, which descends from 1 to the
/// root without overshooting.
double fifth_root(double value) {
	double root = 1.0;
	for (int step = 0; step < 64; ++step) {
		const double square = root * root;
		root = (4.0 * root + value / (square * square)) / 5.0;
	}
	return root;
}

double linear_of(double encoded) {
	if (encoded <= 0.04045) {
		return encoded / 12.92;
	}
	const double base = (encoded + 0.055) / 1.055;
	return base * base * fifth_root(base * base); // Returns base to the power of 2.4.
}

} // namespace

SrgbCurve::SrgbCurve() {
	for (std::size_t byte = 0; byte < linear_.size(); ++byte) {
		linear_[byte] = static_cast<float>(linear_of(static_cast<double>(byte) / 255.0));
	}
}

const SrgbCurve &SrgbCurve::get() {
	static const SrgbCurve curve;
	return curve;
}

float SrgbCurve::linear(float encoded) const {
	if (!(encoded > 0.0F)) {
		return 0.0F;
	}
	return encoded >= 1.0F ? 1.0F : static_cast<float>(linear_of(static_cast<double>(encoded)));
}

std::uint8_t SrgbCurve::encoded(float linear) const {
	if (!(linear > 0.0F)) {
		return 0;
	}
	const auto upper = static_cast<std::size_t>(std::ranges::lower_bound(linear_, linear) - linear_.begin());
	if (upper == linear_.size()) {
		return 255;
	}
	const bool is_lower_nearer = upper > 0 && linear - linear_[upper - 1] < linear_[upper] - linear;
	return static_cast<std::uint8_t>(is_lower_nearer ? upper - 1 : upper);
}

std::uint8_t unit_byte(float value) {
	if (!(value > 0.0F)) {
		return 0;
	}
	return value >= 1.0F ? std::uint8_t{255} : static_cast<std::uint8_t>(value * 255.0F + 0.5F);
}

} // namespace thicket
