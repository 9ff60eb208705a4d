// Runs the destructors of static objects when the library is closed, before its code goes. The start files of most compilers
// do it; those of zig do not, and the engine would call into the unloaded library at its end.

extern "C" {
extern void *__dso_handle;
void __cxa_finalize(void *library);
}

namespace {

__attribute__((destructor)) void finalize() { __cxa_finalize(&__dso_handle); }

} // namespace
