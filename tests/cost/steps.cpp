#include "tests/cost/steps.hpp"

#include <cstddef>
#include <cstdint>

namespace {

thread_local std::uint64_t step_count = 0;

constexpr std::size_t bytes_a_step = 16;

__attribute__((no_sanitize_coverage)) void count_bytes(std::size_t size) { step_count += size / bytes_a_step; }

} // namespace

namespace thicket::cost {

__attribute__((no_sanitize_coverage)) std::uint64_t steps() { return step_count; }

} // namespace thicket::cost

// The compiler inserts a call to the first function into every basic block
// (-fsanitize-coverage=trace-pc). The other functions wrap functions of the C library (the linker
// option --wrap), because the C library contains no such calls.
extern "C" {

__attribute__((no_sanitize_coverage)) void __sanitizer_cov_trace_pc() { ++step_count; }

void *__real_memmove(void *to, const void *from, std::size_t size);
void *__real_memcpy(void *to, const void *from, std::size_t size);
void *__real_memset(void *to, int byte, std::size_t size);

__attribute__((no_sanitize_coverage)) void *__wrap_memmove(void *to, const void *from, std::size_t size) {
	count_bytes(size);
	return __real_memmove(to, from, size);
}

__attribute__((no_sanitize_coverage)) void *__wrap_memcpy(void *to, const void *from, std::size_t size) {
	count_bytes(size);
	return __real_memcpy(to, from, size);
}

__attribute__((no_sanitize_coverage)) void *__wrap_memset(void *to, int byte, std::size_t size) {
	count_bytes(size);
	return __real_memset(to, byte, size);
}
}
