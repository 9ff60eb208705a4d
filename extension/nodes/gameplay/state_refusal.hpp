#pragma once

#include "core/base/status.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <string>

namespace thicket {

/// Says which method of a ScatterState was refused, and why.
inline godot::Error told(const char *p_method, const Status &status) {
	if (status.ok()) {
		return godot::OK;
	}
	ERR_PRINT(godot::String((std::string("ScatterState.") + p_method + ": " + describe(status)).c_str()));
	return status.code == ErrorCode::corrupt ? godot::ERR_FILE_CORRUPT : godot::ERR_INVALID_DATA;
}

} // namespace thicket
