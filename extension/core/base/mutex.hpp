#pragma once

#include <mutex>

namespace thicket {

#if defined(__wasi__) && !defined(_REENTRANT)
/// A mutex that does nothing. WebAssembly outside of browsers has a single thread, and its C++
/// library has no mutex.
class Mutex {
public:
	void lock() {}
	void unlock() {}
};
#else
using Mutex = std::mutex;
#endif

} // namespace thicket
