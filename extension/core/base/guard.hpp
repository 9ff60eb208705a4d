#pragma once

#include "core/base/status.hpp"

#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace thicket {

/// The border of the core: every public function that allocates memory does its work inside this call. Runs `work`,
/// which returns a Status or nothing. If memory runs out, returns ErrorCode::out_of_memory, with the name and the size
/// of the request. A request that exceeds the maximum size of a container counts as out of memory as well.
///
/// `work` allocates all the memory it needs before it changes anything that outlives the call, so a failure leaves
/// everything unchanged. A function that promises more than this documents its promise.
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

/// Calls `guarded` with work that collects an answer in `r_answer`. After a failure of any kind, `r_answer` is empty.
template <typename Answer, typename Work>
Status guarded_answer(const char *asked_for, double value, Answer &r_answer, Work &&work) {
	const Status status = guarded(asked_for, value, std::forward<Work>(work));
	if (!status.ok()) {
		r_answer.clear();
	}
	return status;
}

/// The reverse of `guarded`, for code within the core that calls a guarded function and has no status to return. Throws
/// if that call ran out of memory, and the guard of the calling function catches the exception.
inline void throw_if_out_of_memory(const Status &status) {
	if (status.code == ErrorCode::out_of_memory) {
		throw std::bad_alloc();
	}
}

} // namespace thicket
