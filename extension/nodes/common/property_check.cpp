#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace thicket {

namespace {

/// Whole numbers in full, all others in nine digits.
std::string as_text(double number) {
	constexpr double largest_whole = 1e15;
	const bool is_whole = std::abs(number) < largest_whole && number == std::floor(number);
	std::array<char, 32> text{};
	std::snprintf(text.data(), text.size(), is_whole ? "%.0f" : "%.9g", number);
	return text.data();
}

std::string range_text(double min, double max) {
	if (max >= std::numeric_limits<double>::max()) {
		return "at least " + as_text(min);
	}
	if (min <= std::numeric_limits<double>::lowest()) {
		return "at most " + as_text(max);
	}
	return "between " + as_text(min) + " and " + as_text(max);
}

} // namespace

bool accept_number(const char *owner, const char *property, double value, double min, double max) {
	const bool is_finite = std::isfinite(value);
	if (is_finite && value >= min && value <= max) {
		return true;
	}
	const std::string text = std::string(owner) + "." + property + " must be " + (is_finite ? "" : "finite, ") +
			range_text(min, max) + ", got " + as_text(value) + ". The last valid value stays; set one in this range.";
	ERR_PRINT(godot::String(text.c_str()));
	return false;
}

void report(const char *owner, const Status &status) {
	if (!status.ok() && status.code != ErrorCode::cancelled) {
		ERR_PRINT(sentence(owner, status));
	}
}

godot::String sentence(const char *owner, const Status &status) {
	return godot::String((std::string(owner) + "." + describe(status)).c_str());
}

} // namespace thicket
