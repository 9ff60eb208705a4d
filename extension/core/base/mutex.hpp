#pragma once

#include <mutex>

namespace thicket {

#if defined(__wasi__) && !defined(_REENTRANT)
/// WebAssembly outside of browsers has one thread, and its C++ library has no mutex.
class Mutex {
public:
	void lock() {}
	void unlock() {}
};
#else
using Mutex = std::mutex;
#endif

} // namespace thicket
