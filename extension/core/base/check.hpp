#pragma once

#include "core/base/status.hpp"

#include <cmath>

namespace thicket {

/// Returns an error if a value is not finite or outside `allowed`. `property` and `remedy` must be
/// string literals.
inline Status check_range(const char *property, double value, const AllowedRange &allowed, const char *remedy = "") {
	Status status = Status::out_of_range(property, value, allowed, remedy);
	if (!std::isfinite(value)) {
		status.code = ErrorCode::not_finite;
		return status;
	}
	return value < allowed.min || value > allowed.max ? status : Status();
}

inline Status check_range(const char *property, double value, double min, double max) {
	return check_range(property, value, between(min, max));
}

/// Returns an error if a value is not finite or not above 0.
inline Status check_positive(const char *property, double value) {
	if (!std::isfinite(value)) {
		return {ErrorCode::not_finite, property, value};
	}
	if (value <= 0.0) {
		return {ErrorCode::not_positive, property, value};
	}
	return {};
}

/// Values of Status::remedy that several modules share.
inline constexpr const char *negative_size = "Use a size that is not negative";
inline constexpr const char *newer_version = "A newer version of Thicket created this data. Update Thicket to read it";

/// Returns an error if the maximum of a range is below its minimum. The status names the maximum,
/// `max_property`.
inline Status check_order(const char *max_property, double min, double max) {
	if (max < min) {
		return {ErrorCode::inverted, max_property, max, {}, at_least(min, "the start of its range"),
				"Increase it, or lower the start of the range"};
	}
	return {};
}

/// Returns the first status that is an error, or an ok status if there is none.
template <typename... Statuses>
Status first_failure(const Statuses &...statuses) {
	Status result;
	static_cast<void>(((result = statuses, !result.ok()) || ...));
	return result;
}

} // namespace thicket
