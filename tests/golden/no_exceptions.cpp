// Replaces the functions that throw exceptions with functions that abort the program. For programs
// whose C++ library does not support exceptions.

#include <cstddef>
#include <cstdlib>

extern "C" {
void *__cxa_allocate_exception(std::size_t) noexcept { std::abort(); } // NOLINT: the library's names.
[[noreturn]] void __cxa_throw(void *, void *, void (*)(void *)) noexcept { std::abort(); } // NOLINT
}
