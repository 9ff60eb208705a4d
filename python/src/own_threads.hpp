#pragma once

#include "core/base/caller_threads.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace thicket::python {

/// Threads for one call. They run only code of the core and never take the interpreter's lock.
class OwnThreads : public CallerThreads {
public:
	/// Creates a set of `count` threads in addition to the calling one.
	explicit OwnThreads(std::size_t count) : count_(count) {}

	/// Returns the number of cores minus one for the calling thread.
	static std::size_t spare() { return std::max(std::thread::hardware_concurrency(), 1u) - 1; }

	std::size_t count() const override { return count_; }

	/// If the system cannot start more threads, the existing ones do all the work.
	void run(const std::function<void(std::size_t index)> &work) override {
		std::vector<std::jthread> threads; // The destructor waits for all of them.
		try {
			threads.reserve(count_);
			for (std::size_t index = 1; index <= count_; ++index) {
				threads.emplace_back([&work, index] { work(index); });
			}
		} catch (const std::exception &) { // NOLINT(bugprone-empty-catch)
		}
		work(0);
	}

private:
	std::size_t count_;
};

} // namespace thicket::python
