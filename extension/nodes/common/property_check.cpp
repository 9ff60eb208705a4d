#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <cmath>
#include <string>

namespace thicket {

bool accept_number(const char *owner, const char *property, double value, double min, double max) {
	Status status{ErrorCode::none, property, value};
	if (!std::isfinite(value)) {
		status.code = ErrorCode::not_finite;
	} else if (value <= 0.0 && min > 0.0) {
		status.code = ErrorCode::not_positive;
	} else if (value < min || value > max) {
		status.code = ErrorCode::out_of_range;
	}
	report(owner, status);
	return status.ok();
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
