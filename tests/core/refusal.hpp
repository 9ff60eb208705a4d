#pragma once

#include "core/base/status.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinite_value = std::numeric_limits<double>::infinity();

/// Checks that a call failed with this error code, property and value, and that the message names
/// the property.
inline void check_refused(
		const thicket::Status &status, thicket::ErrorCode code, const std::string &property, double value) {
	CAPTURE(property);
	CAPTURE(value);
	CHECK(status.code == code);
	CHECK(status.property == property);
	CHECK((status.value == value || (std::isnan(value) && std::isnan(status.value))));
	CHECK(describe(status).find(property) != std::string::npos);
}
