#pragma once

#include "core/base/status.hpp"
#include "core/state/diff_limits.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <string>

namespace thicket {

/// The engine's error for a refusal: also of a diff whose order or limits are not met.
inline godot::Error error_of_state(const Status &status) {
	if (is_missing_earlier(status)) {
		return godot::ERR_UNAVAILABLE;
	}
	return is_beyond_limits(status) ? godot::ERR_UNAUTHORIZED : error_of(status);
}

/// Says which method of a ScatterState was refused, and why.
inline godot::Error told(const char *p_method, const Status &status) {
	if (!status.ok()) {
		ERR_PRINT(godot::String((std::string("ScatterState.") + p_method + ": " + describe(status)).c_str()));
	}
	return error_of_state(status);
}

} // namespace thicket
