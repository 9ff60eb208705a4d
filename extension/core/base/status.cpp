#include "core/base/status.hpp"

#include <array>
#include <cstdio>

namespace thicket {

namespace {

const char *demand(ErrorCode code) {
	switch (code) {
		case ErrorCode::none: return "is fine";
		case ErrorCode::not_finite: return "must be finite";
		case ErrorCode::not_positive: return "must be positive";
		case ErrorCode::out_of_range: return "is out of range";
		case ErrorCode::inverted: return "ends before it starts";
		case ErrorCode::too_many_points: return "asks for too many points";
		case ErrorCode::missing: return "is missing";
		case ErrorCode::wrong_size: return "has the wrong size";
		case ErrorCode::out_of_memory: return "needs more memory than there is";
		case ErrorCode::corrupt: return "is truncated, damaged or of another kind";
		case ErrorCode::foreign: return "was made for another seed, radius or number of levels";
		case ErrorCode::margin_too_wide: return "needs a wider margin of cells than is allowed";
		case ErrorCode::cancelled: return "was cancelled";
	}
	return "is invalid";
}

std::string as_text(double number) {
	std::array<char, 32> text{};
	std::snprintf(text.data(), text.size(), "%.9g", number);
	return text.data();
}

} // namespace

std::string describe(const Status &status) {
	std::string text = status.property;
	text += ' ';
	text += demand(status.code);
	const bool has_value = status.code != ErrorCode::missing && status.code != ErrorCode::none &&
			status.code != ErrorCode::corrupt && status.code != ErrorCode::cancelled;
	if (has_value) {
		text += ", got ";
		text += as_text(status.value);
	}
	if (const PointSetSite &site = status.site; site.radius > 0.0) {
		text += " (seed " + std::to_string(site.seed) + ", radius " + as_text(site.radius) + ", position (" +
				as_text(site.position.x) + ", " + as_text(site.position.y) + "))";
	}
	return text;
}

} // namespace thicket
