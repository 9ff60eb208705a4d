#pragma once

#include "core/base/status.hpp"

#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace thicket {

/// The border of the core: every function that is called from outside and takes memory does its work in here. Runs `work`,
/// which returns a Status or nothing. Where memory ends, that becomes ErrorCode::out_of_memory, which names what was asked
/// for and how large that was: a request so large that no container can hold it counts as well.
///
/// `work` takes all the memory that it needs before it changes anything that outlives the call, so that a failure leaves
/// everything as it was. What else is promised of a failed call, its docstring says.
template <typename Work>
Status guarded(const char *asked_for, double value, Work &&work) {
	try {
		if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
			std::forward<Work>(work)();
			return {};
		} else {
			return std::forward<Work>(work)();
		}
	} catch (const std::bad_alloc &) {
	} catch (const std::length_error &) {}
	return {ErrorCode::out_of_memory, asked_for, value};
}

/// As above, for an answer that is put together in `r_answer`: after a failure of any kind that is empty.
template <typename Answer, typename Work>
Status guarded_answer(const char *asked_for, double value, Answer &r_answer, Work &&work) {
	const Status status = guarded(asked_for, value, std::forward<Work>(work));
	if (!status.ok()) {
		r_answer.clear();
	}
	return status;
}

/// The way back, for code within the core that calls a guarded function and has no status to return: throws if memory ended
/// there, to be caught at the border of its own caller.
inline void throw_if_out_of_memory(const Status &status) {
	if (status.code == ErrorCode::out_of_memory) {
		throw std::bad_alloc();
	}
}

} // namespace thicket
