#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace thicket::analysis {

/// Adds doubles, and products of two doubles, without any rounding. It uses Shewchuk's expansions
/// ("Adaptive Precision Floating-Point Arithmetic", 1997, sections 2.4 and 2.5). The sum is exact
/// unless a product is subnormal or near overflow.
class ExactSum {
public:
	void add(double value) {
		std::size_t kept_count = 0;
		for (std::size_t i = 0; i < count_; ++i) {
			const double sum = value + parts_[i];
			const double rounded_part = sum - value;
			const double error = (value - (sum - rounded_part)) + (parts_[i] - rounded_part);
			if (error != 0.0) {
				parts_[kept_count++] = error;
			}
			value = sum;
		}
		if (value != 0.0) {
			parts_[kept_count++] = value;
		}
		count_ = kept_count;
	}

	void add_product(double a, double b) {
		const double product = a * b;
		// The product's rounding error, computed from halves whose products are exact (Dekker).
		// std::fma is avoided because an implementation on Windows returned 6e-294 instead of 0.
		const auto [a_high, a_low] = halves(a);
		const auto [b_high, b_low] = halves(b);
		add(a_low * b_low - (product - a_high * b_high - a_low * b_high - a_high * b_low));
		add(product);
	}

	/// Returns -1, 0 or 1. The parts do not overlap and are sorted by ascending magnitude, so the
	/// last one determines the sign.
	int sign() const { return count_ == 0 ? 0 : parts_[count_ - 1] < 0.0 ? -1 : 1; }

private:
	static constexpr std::size_t max_parts = 40;

	/// Splits `value` into two 26-bit numbers whose sum is exactly `value`.
	static std::pair<double, double> halves(double value) {
		const double scaled = (0x1p27 + 1.0) * value;
		const double high = scaled - (scaled - value);
		return {high, value - high};
	}

	std::array<double, max_parts> parts_{};
	std::size_t count_ = 0;
};

/// Returns the number to add to `difference` to reach the nearest periodic image. Returns 0 if
/// `period` is 0, which means that the axis is not periodic.
inline double nearest_image(double difference, double period) {
	return period > 0.0 ? -period * std::round(difference / period) : 0.0;
}

/// Adds the square of a - b + shift, exactly.
inline void add_square(ExactSum &r_sum, double a, double b, double shift) {
	const std::array terms = {a, -b, shift};
	for (std::size_t i = 0; i < terms.size(); ++i) {
		r_sum.add_product(terms[i], terms[i]);
		for (std::size_t j = i + 1; j < terms.size(); ++j) {
			r_sum.add_product(2.0 * terms[i], terms[j]);
		}
	}
}

/// Returns the sign of |a - b|^2 - radius^2, computed without rounding. A `period` of 0 means that
/// the axis is not periodic.
inline int compare_distance_exactly(glm::dvec2 a, glm::dvec2 b, glm::dvec2 period, double radius) {
	ExactSum sum;
	add_square(sum, a.x, b.x, nearest_image(a.x - b.x, period.x));
	add_square(sum, a.y, b.y, nearest_image(a.y - b.y, period.y));
	sum.add_product(-radius, radius);
	return sum.sign();
}

/// Returns the same result as `compare_distance_exactly`, but computes the exact sum only if double
/// precision is inconclusive.
inline int compare_distance(glm::dvec2 a, glm::dvec2 b, glm::dvec2 period, double radius) {
	glm::dvec2 d = a - b;
	d += glm::dvec2(nearest_image(d.x, period.x), nearest_image(d.y, period.y));
	const double excess = d.x * d.x + d.y * d.y - radius * radius;
	// A difference is off by at most two roundings of the largest number. The squares add their own
	// rounding errors.
	const glm::dvec2 largest = glm::max(glm::max(glm::abs(a), glm::abs(b)), period);
	const double error = 0x1p-49 * (radius * radius + d.x * d.x + d.y * d.y) +
			0x1p-49 * (largest.x * std::abs(d.x) + largest.y * std::abs(d.y)) +
			0x1p-98 * (largest.x * largest.x + largest.y * largest.y);
	if (std::abs(excess) > error) {
		return excess < 0.0 ? -1 : 1;
	}
	return compare_distance_exactly(a, b, period, radius);
}

} // namespace thicket::analysis
