// For programs whose C++ library has no exceptions: throwing one ends the program.

#include <cstddef>
#include <cstdlib>

extern "C" {
void *__cxa_allocate_exception(std::size_t) noexcept { std::abort(); } // NOLINT: the library's names.
[[noreturn]] void __cxa_throw(void *, void *, void (*)(void *)) noexcept { std::abort(); } // NOLINT
}
