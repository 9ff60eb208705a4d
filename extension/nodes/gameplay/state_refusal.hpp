#pragma once

#include "core/base/status.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <string>

namespace thicket {

/// Prints which method of a ScatterState was refused, and why. Returns the error, or OK, without a message, if the
/// status is ok.
inline godot::Error told(const char *p_method, const Status &status) {
	if (!status.ok()) {
		ERR_PRINT(godot::String((std::string("ScatterState.") + p_method + ": " + describe(status)).c_str()));
	}
	return error_of(status);
}

} // namespace thicket
