#include "core/base/orientation.hpp"

#include "core/base/floating_point.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

/// An exact number, stored as a sum of nonoverlapping doubles, smallest first.
class Expansion {
public:
	/// Adds `value` exactly (Shewchuk's Grow-Expansion).
	void add(double value) {
		for (std::size_t i = 0; i < size_; ++i) {
			const double sum = parts_[i] + value;
			const double part = sum - value;
			parts_[i] = (parts_[i] - part) + (value - (sum - part));
			value = sum;
		}
		parts_[size_++] = value;
	}

	/// Adds a * b exactly (Dekker's product: halves of 26 bits multiply exactly).
	void add_product(double a, double b) {
		const double product = a * b;
		const auto [a_high, a_low] = halves(a);
		const auto [b_high, b_low] = halves(b);
		add(a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low));
		add(product);
	}

	/// Returns the rounded sum. It has the sign of the exact sum, because the last part is larger
	/// than the sum of all parts before it.
	double value() const {
		double sum = 0.0;
		for (std::size_t i = 0; i < size_; ++i) {
			sum += parts_[i];
		}
		return sum;
	}

private:
	struct Halves {
		double high;
		double low;
	};

	static Halves halves(double value) {
		constexpr double splitter = 134217729.0; // 2^27 + 1
		const double shifted = splitter * value;
		const double high = shifted - (shifted - value);
		return {high, value - high};
	}

	std::array<double, 12> parts_{};
	std::size_t size_ = 0;
};

double exact_orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
	Expansion sum;
	sum.add_product(a.x, b.y);
	sum.add_product(-a.y, b.x);
	sum.add_product(b.x, c.y);
	sum.add_product(-b.y, c.x);
	sum.add_product(c.x, a.y);
	sum.add_product(-c.y, a.x);
	return sum.value();
}

} // namespace

double orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
	constexpr double rounding = 3.3306690738754716e-16; // Relative error bound: (3 + 16 e) e with e = 2^-53.
	// Above this threshold, the relative error of the result is at most 2^-26.
	constexpr double exact_threshold = rounding * (1 << 26);
	const double left = (a.x - c.x) * (b.y - c.y);
	const double right = (a.y - c.y) * (b.x - c.x);
	const double quick = left - right;
	if (std::abs(quick) > exact_threshold * (std::abs(left) + std::abs(right))) {
		// The value is so far from 0 that rounding cannot have changed its sign.
		return quick;
	}
	return exact_orientation(a, b, c);
}

} // namespace thicket
