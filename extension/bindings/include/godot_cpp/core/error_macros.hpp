#pragma once

#include <godot_cpp/variant/string.hpp>

namespace godot {

/// Prints to the engine's log with the place in the source (`print_error_with_message`, `print_warning_with_message`).
void _err_print_error(const char *p_function, const char *p_file, int p_line, const char *p_error,
		const String &p_message = String(), bool p_is_warning = false);

} // namespace godot

#define ERR_PRINT(m_message) ::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, "", m_message)
#define WARN_PRINT(m_message) ::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, "", m_message, true)

#define ERR_FAIL_COND_V_MSG(m_condition, m_result, m_message) \
	do { \
		if (m_condition) { \
			::godot::_err_print_error(__FUNCTION__, __FILE__, __LINE__, "Condition \"" #m_condition "\" is true.", m_message); \
			return m_result; \
		} \
	} while (false)
#define ERR_FAIL_COND_V(m_condition, m_result) ERR_FAIL_COND_V_MSG(m_condition, m_result, ::godot::String())
#define ERR_FAIL_COND_MSG(m_condition, m_message) ERR_FAIL_COND_V_MSG(m_condition, , m_message)
#define ERR_FAIL_COND(m_condition) ERR_FAIL_COND_V_MSG(m_condition, , ::godot::String())
