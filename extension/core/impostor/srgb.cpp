#include "core/impostor/srgb.hpp"

#include <algorithm>
#include <cstddef>

namespace thicket {

namespace {

/// Returns the fifth root of a number in (0, 1], by Newton's method, which descends from 1 to the
/// root without overshooting.
double fifth_root(double number) {
	double root = 1.0;
	for (int step = 0; step < 64; ++step) {
		const double square = root * root;
		root = (4.0 * root + number / (square * square)) / 5.0;
	}
	return root;
}

double linear_of(double stored) {
	if (stored <= 0.04045) {
		return stored / 12.92;
	}
	const double base = (stored + 0.055) / 1.055;
	return base * base * fifth_root(base * base); // Returns base to the power of 2.4.
}

} // namespace

SrgbCurve::SrgbCurve() {
	for (std::size_t at = 0; at < linear_.size(); ++at) {
		linear_[at] = static_cast<float>(linear_of(static_cast<double>(at) / 255.0));
	}
}

const SrgbCurve &SrgbCurve::get() {
	static const SrgbCurve curve;
	return curve;
}

float SrgbCurve::linear(float stored) const {
	if (!(stored > 0.0F)) {
		return 0.0F;
	}
	return stored >= 1.0F ? 1.0F : static_cast<float>(linear_of(static_cast<double>(stored)));
}

std::uint8_t SrgbCurve::stored(float linear) const {
	if (!(linear > 0.0F)) {
		return 0;
	}
	const auto above = static_cast<std::size_t>(std::ranges::lower_bound(linear_, linear) - linear_.begin());
	if (above == linear_.size()) {
		return 255;
	}
	const bool nearer_below = above > 0 && linear - linear_[above - 1] < linear_[above] - linear;
	return static_cast<std::uint8_t>(nearer_below ? above - 1 : above);
}

std::uint8_t unit_byte(float value) {
	if (!(value > 0.0F)) {
		return 0;
	}
	return value >= 1.0F ? std::uint8_t{255} : static_cast<std::uint8_t>(value * 255.0F + 0.5F);
}

} // namespace thicket
