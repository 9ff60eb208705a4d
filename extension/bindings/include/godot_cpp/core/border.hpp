#pragma once

#include <type_traits>

namespace godot::internal {

/// Prints an error for the exception that is being handled. Takes no memory.
void report_exception(const char *p_entry) noexcept;

/// Does the work of an entry that the engine calls. An exception must not reach the engine, which would keep its locks and end: it becomes
/// an error, and the result a default one.
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
