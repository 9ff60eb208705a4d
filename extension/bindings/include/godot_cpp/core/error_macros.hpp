#pragma once

#include <godot_cpp/variant/string.hpp>

namespace godot {

/// Prints an error to the engine's log with its place in the source (`print_error`).
void _err_print_error(const char *p_function, const char *p_file, int p_line, const String &p_message);

} // namespace godot

#define ERR_PRINT(m_message) ::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, m_message)
