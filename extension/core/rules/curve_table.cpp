#include "core/rules/curve_table.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

Status CurveTable::set(double min, double max, std::span<const float> samples) {
	constexpr double lowest = std::numeric_limits<double>::lowest();
	constexpr double highest = std::numeric_limits<double>::max();
	if (const Status status = first_failure(check_range("min", min, lowest, highest),
				check_range("max", max, lowest, highest), check_order("max", min, max));
			!status.ok()) {
		return status;
	}
	if (min == max) {
		return {ErrorCode::inverted, "max", max, {}, {}, "Use a maximum above the minimum"};
	}
	if (samples.size() < 2 || samples.size() > max_curve_samples) {
		return Status::wrong_size("samples", samples.size(), between(2, max_curve_samples));
	}
	for (const float sample : samples) {
		if (const Status status = check_range("samples", sample, 0.0, 1.0); !status.ok()) {
			return status;
		}
	}
	return guarded("samples", static_cast<double>(samples.size()), [&] {
		samples_ = std::vector<float>(samples.begin(), samples.end());
		min_ = min;
		max_ = max;
	});
}

double CurveTable::at(double x) const {
	if (std::isnan(x)) {
		return 0.0;
	}
	if (x <= min_) {
		return samples_.front();
	}
	if (x >= max_) {
		return samples_.back();
	}
	// If max - min would overflow, all terms are halved.
	const double scale = std::isfinite(max_ - min_) ? 1.0 : 0.5;
	const double fraction = (x * scale - min_ * scale) / (max_ * scale - min_ * scale);
	const double sample_position = fraction * static_cast<double>(samples_.size() - 1);
	const std::size_t index = std::min(static_cast<std::size_t>(sample_position), samples_.size() - 2);
	const double first = samples_[index];
	const double second = samples_[index + 1];
	const double value = first + (second - first) * (sample_position - static_cast<double>(index));
	// Rounding may overshoot the samples by one ulp.
	return std::clamp(value, std::min(first, second), std::max(first, second));
}

double CurveTable::largest() const { return *std::max_element(samples_.begin(), samples_.end()); }

} // namespace thicket
