#pragma once

#include "core/base/status.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_curve_samples = 4096;

/// A density as a function of one number, such as the height in meters: evenly spaced samples, linearly interpolated. Immutable after
/// `set`, so threads may share one.
class CurveTable {
public:
	CurveTable() = default; ///< 1 everywhere.

	/// `samples` run from the value at `min` to the value at `max`, both included: 2 to max_curve_samples numbers from 0 to 1. `min` and
	/// `max` are finite, and min < max. Anything else is refused and changes nothing.
	Status set(double min, double max, std::span<const float> samples);

	/// The density, 0 to 1. Beyond min and max, the value at the nearer end; 0 for NAN. Bit-identical everywhere.
	double at(double x) const;

	/// The largest value of the curve. If it is 0, nothing passes.
	double largest() const;

	friend bool operator==(const CurveTable &, const CurveTable &) = default;

private:
	double min_ = 0.0;
	double max_ = 1.0;
	std::vector<float> samples_{1.0f, 1.0f};
};

} // namespace thicket
