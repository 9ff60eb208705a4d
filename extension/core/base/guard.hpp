#pragma once

#include "core/base/status.hpp"

#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace thicket {

/// The exception boundary of the core: every public function that allocates memory does its work
/// inside this call. `guarded` runs `work`, which returns a Status or nothing. If memory runs out
/// or a request exceeds the maximum size of a container, it returns ErrorCode::out_of_memory. The
/// status has `asked_for` as its property (a string literal) and `value` as its value.
///
/// `work` must allocate all its memory before it changes anything that outlives the call, so that a
/// failure leaves everything unchanged. Functions with stronger guarantees document them.
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

/// Runs `work` like `guarded`, for work that collects its result in `r_answer`. After any failure,
/// `r_answer` is empty.
template <typename Answer, typename Work>
Status guarded_answer(const char *asked_for, double value, Answer &r_answer, Work &&work) {
	const Status status = guarded(asked_for, value, std::forward<Work>(work));
	if (!status.ok()) {
		r_answer.clear();
	}
	return status;
}

/// The inverse of `guarded`, for code in the core that calls a guarded function but cannot return a
/// status. Throws std::bad_alloc if the call ran out of memory. The guard of the caller catches the
/// exception.
inline void throw_if_out_of_memory(const Status &status) {
	if (status.code == ErrorCode::out_of_memory) {
		throw std::bad_alloc();
	}
}

} // namespace thicket
