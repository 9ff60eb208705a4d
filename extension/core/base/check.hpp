#pragma once

#include "core/base/status.hpp"

#include <cmath>

namespace thicket {

/// Refuses a value that is not finite or outside [min, max]. `property` is a string literal.
inline Status check_range(const char *property, double value, double min, double max) {
	if (!std::isfinite(value)) {
		return {ErrorCode::not_finite, property, value};
	}
	if (value < min || value > max) {
		return {ErrorCode::out_of_range, property, value};
	}
	return {};
}

/// Refuses a value that is not finite or not above 0.
inline Status check_positive(const char *property, double value) {
	if (!std::isfinite(value)) {
		return {ErrorCode::not_finite, property, value};
	}
	if (value <= 0.0) {
		return {ErrorCode::not_positive, property, value};
	}
	return {};
}

/// Refuses a range whose end lies before its start, under the name of its end.
inline Status check_order(const char *max_property, double min, double max) {
	if (max < min) {
		return {ErrorCode::inverted, max_property, max};
	}
	return {};
}

/// The first of several checks that failed, or ok.
template <typename... Statuses>
Status first_failure(const Statuses &...statuses) {
	Status result;
	static_cast<void>(((result = statuses, !result.ok()) || ...));
	return result;
}

} // namespace thicket
