#pragma once

#include <type_traits>

namespace godot::internal {

/// Prints an error for the current exception, without allocating memory.
void report_exception(const char *p_entry) noexcept;

/// Runs the body of a function that the engine calls. An exception must not propagate into the
/// engine, which would keep its locks and crash. If `p_work` throws, prints an error with the name
/// `p_entry` and returns a default value.
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
