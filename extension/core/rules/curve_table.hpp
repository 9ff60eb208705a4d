#pragma once

#include "core/base/status.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_curve_samples = 4096;

/// A density as a function of one number, such as the height in meters. The table stores evenly
/// spaced samples, between which it interpolates linearly. It is immutable after `set`, so threads
/// may share it.
class CurveTable {
public:
	CurveTable() = default; ///< Creates a curve that is 1 everywhere.

	/// Sets the samples: 2 to max_curve_samples densities from 0 to 1, evenly spaced from `min` to
	/// `max` inclusive. `min` and `max` are finite, and min < max. Any other value is an error and
	/// leaves the table unchanged.
	Status set(double min, double max, std::span<const float> samples);

	/// Returns the density, 0 to 1. Outside min and max, the density is the value at the nearer
	/// end; for NAN, it is 0. The result is bit-identical on all platforms.
	double at(double x) const;

	/// Returns the largest sample. If it is 0, the density is 0 everywhere.
	double largest() const;

	friend bool operator==(const CurveTable &, const CurveTable &) = default;

private:
	double min_ = 0.0;
	double max_ = 1.0;
	std::vector<float> samples_{1.0f, 1.0f};
};

} // namespace thicket
