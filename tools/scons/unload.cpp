// Runs the destructors of static objects when the library is closed, before its code is unloaded.
// The start files of most compilers do this, but zig's do not. Without this file, the engine would
// call into the unloaded library on exit.

extern "C" {
extern void *__dso_handle;
void __cxa_finalize(void *library);
}

namespace {

__attribute__((destructor)) void finalize() { __cxa_finalize(&__dso_handle); }

} // namespace
