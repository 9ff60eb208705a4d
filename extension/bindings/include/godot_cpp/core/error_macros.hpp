#pragma once

#include <godot_cpp/variant/string.hpp>

namespace godot {

/// Prints an error or a warning to the engine's log, with its source location.
void _err_print_error(const char *p_function, const char *p_file, int p_line, const String &p_message,
		bool p_editor_notify = false, bool p_is_warning = false);

} // namespace godot

#define ERR_PRINT(m_message) ::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, m_message)
#define WARN_PRINT(m_message) ::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, m_message, false, true)
