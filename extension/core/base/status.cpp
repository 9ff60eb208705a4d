#include "core/base/status.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace thicket {

namespace {

/// Formats whole numbers with all digits, and other numbers with nine significant digits.
std::string as_text(double number) {
	constexpr double largest_whole = 1e15;
	const bool is_whole = std::abs(number) < largest_whole && number == std::floor(number);
	std::array<char, 32> text{};
	std::snprintf(text.data(), text.size(), is_whole ? "%.0f" : "%.9g", number);
	return text.data();
}

std::string text_of(const AllowedRange &allowed) {
	std::string text;
	if (allowed.min == allowed.max) {
		text = as_text(allowed.min);
	} else if (allowed.has_min() && allowed.has_max()) {
		text = "between " + as_text(allowed.min) + " and " + as_text(allowed.max);
	} else if (allowed.has_min()) {
		text = "at least " + as_text(allowed.min);
	} else if (allowed.has_max()) {
		text = "at most " + as_text(allowed.max);
	}
	return *allowed.note == '\0' ? text : text + " (" + allowed.note + ")";
}

/// Returns the violated requirement, without the value. `allowed` is the text for the allowed
/// range, or empty if no range is known.
std::string requirement_text(ErrorCode code, const std::string &allowed) {
	const bool known = !allowed.empty();
	switch (code) {
		case ErrorCode::none: return "is valid";
		case ErrorCode::not_finite: return known ? "must be finite, " + allowed : "must be finite";
		case ErrorCode::not_positive: return "must be positive";
		case ErrorCode::out_of_range: return known ? "must be " + allowed : "is out of range";
		case ErrorCode::inverted: return known ? "must be " + allowed : "has its end before its start";
		case ErrorCode::too_many_points: return "requires too many points";
		case ErrorCode::missing: return "is missing";
		case ErrorCode::wrong_type: return "has the wrong type";
		case ErrorCode::wrong_size: return known ? "has the wrong size: it must be " + allowed : "has the wrong size";
		case ErrorCode::out_of_memory: return "needs more memory than is available";
		case ErrorCode::corrupt: return "is truncated, corrupt or in another format";
		case ErrorCode::foreign: return "belongs to a different seed, radius or number of levels";
		case ErrorCode::not_allowed: return known ? "must be " + allowed : "is missing";
		case ErrorCode::out_of_order: return known ? "must be " + allowed : "is out of order";
		case ErrorCode::margin_too_wide: return "requires a wider margin of cells than is allowed";
		case ErrorCode::cancelled: return "was cancelled";
	}
	return "is invalid";
}

/// Returns the default explanation of how to fix an error, for a status without a specific one.
const char *default_fix(ErrorCode code) {
	switch (code) {
		case ErrorCode::too_many_points: return "Make the area smaller or the radius larger";
		case ErrorCode::out_of_memory: return "Request less in one call, or free memory";
		case ErrorCode::corrupt: return "Use an intact copy that this version wrote";
		case ErrorCode::foreign: return "Restore the values that it belongs to, or start with a new state";
		case ErrorCode::margin_too_wide: return "Choose a different seed, and report this seed as a bug";
		default: return "";
	}
}

bool has_value(const Status &status) {
	switch (status.code) {
		case ErrorCode::none:
		case ErrorCode::missing:
		case ErrorCode::wrong_type:
		case ErrorCode::corrupt:
		case ErrorCode::foreign:
		case ErrorCode::cancelled: return false;
		case ErrorCode::not_allowed: return status.allowed.has_min() || status.allowed.has_max();
		default: return true;
	}
}

} // namespace

std::string describe(const Status &status) {
	std::string text = status.property;
	text += ' ';
	if (status.code == ErrorCode::foreign) {
		text += as_text(status.value) + ' '; // The property is "layer", for example, and the value its number.
	}
	text += requirement_text(status.code, text_of(status.allowed));
	if (has_value(status)) {
		text += ", got ";
		text += as_text(status.value);
	}
	if (status.code == ErrorCode::too_many_points && status.allowed.has_max()) {
		text += "; at most " + as_text(status.allowed.max) + " are allowed in one call";
	}
	if (const PointSetSite &site = status.site; site.radius > 0.0) {
		text += " (seed " + std::to_string(site.seed) + ", radius " + as_text(site.radius) + ", position (" +
				as_text(site.position.x) + ", " + as_text(site.position.y) + "))";
	}
	if (const char *remedy = *status.remedy != '\0' ? status.remedy : default_fix(status.code); *remedy != '\0') {
		text += ". ";
		text += remedy;
	}
	return text;
}

} // namespace thicket
