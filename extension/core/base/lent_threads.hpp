#pragma once

#include <cstddef>
#include <functional>

namespace thicket {

/// Threads that a caller lends to a call. The core starts no threads.
class LentThreads {
public:
	virtual ~LentThreads() = default;

	/// The number of threads besides the calling one.
	virtual std::size_t count() const = 0;

	/// Calls work(0) on the calling thread and work(1) to work(count()) on other threads, and returns when all calls
	/// have returned. Some of the calls may start late, one after the other, or not at all. So each call must process
	/// all the work that is left. `work` does not throw.
	virtual void run(const std::function<void(std::size_t index)> &work) = 0;

protected:
	LentThreads() = default;
	LentThreads(const LentThreads &) = default;
	LentThreads &operator=(const LentThreads &) = default;
};

} // namespace thicket
