#pragma once

#include "core/base/status.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <string>

namespace thicket {

/// Reports the outcome of a call to a ScatterState method. If the call failed, prints an error with
/// the method and the reason. Returns the error code, or OK.
inline godot::Error report_outcome(const char *p_method, const Status &status) {
	if (!status.ok()) {
		ERR_PRINT(godot::String((std::string("ScatterState.") + p_method + ": " + describe(status)).c_str()));
	}
	return error_of(status);
}

} // namespace thicket
