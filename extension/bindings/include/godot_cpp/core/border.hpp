#pragma once

#include <type_traits>

namespace godot::internal {

/// Prints an error for the current exception. Allocates no memory.
void report_exception(const char *p_entry) noexcept;

/// Runs a function that the engine has called. An exception must not reach the engine, because it would keep its locks and crash. So
/// an exception is reported as an error, and the result is a default value.
template <typename Work>
std::invoke_result_t<Work> at_border(const char *p_entry, const Work &p_work) noexcept {
	try {
		return p_work();
	} catch (...) {
		report_exception(p_entry);
	}
	return std::invoke_result_t<Work>();
}

} // namespace godot::internal
