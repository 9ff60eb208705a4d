#include "nodes/common/property_check.hpp"

#include "core/base/check.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <string>
#include <string_view>

namespace thicket {

bool accept_number(const char *owner, const char *property, double value, double min, double max) {
	const Status status =
			check_range(property, value, between(min, max), "The last valid value is kept; set a value in this range");
	report(owner, status);
	return status.ok();
}

void report(const char *owner, const Status &status) { report(owner, status, ""); }

void report(const char *owner, const Status &status, const std::string &details) {
	if (!status.ok() && status.code != ErrorCode::cancelled) {
		const godot::String text = sentence(owner, status);
		ERR_PRINT(details.empty() ? text : text + godot::String(". ") + godot::String::utf8(details.c_str()));
	}
}

godot::Error error_of(const Status &status) {
	switch (status.code) {
		case ErrorCode::none: return godot::OK;
		case ErrorCode::corrupt: return godot::ERR_FILE_CORRUPT;
		case ErrorCode::not_allowed: return godot::ERR_UNAUTHORIZED;
		case ErrorCode::out_of_order: return godot::ERR_UNAVAILABLE;
		default: return godot::ERR_INVALID_DATA;
	}
}

godot::String sentence(const char *owner, const Status &status) {
	const bool is_name = std::string_view(status.property).find(' ') == std::string_view::npos;
	return godot::String((std::string(owner) + (is_name ? "." : ": ") + describe(status)).c_str());
}

} // namespace thicket
