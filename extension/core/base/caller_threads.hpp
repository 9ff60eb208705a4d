#pragma once

#include <cstddef>
#include <functional>

namespace thicket {

/// Threads that a caller lends to a call. The core itself never starts threads.
class CallerThreads {
public:
	virtual ~CallerThreads() = default;

	/// Returns the number of threads that are available in addition to the calling thread.
	virtual std::size_t count() const = 0;

	/// Calls work(0) on the calling thread and work(1) to work(count()) on other threads. Returns
	/// when all calls have returned. Some calls may start late, run one after another, or never
	/// start. Each call must therefore process all remaining work. `work` must not throw.
	virtual void run(const std::function<void(std::size_t index)> &work) = 0;

protected:
	CallerThreads() = default;
	CallerThreads(const CallerThreads &) = default;
	CallerThreads &operator=(const CallerThreads &) = default;
};

} // namespace thicket
