#pragma once

#include "core/base/lent_threads.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

namespace thicket::python {

/// Threads made for one call. They never take the interpreter's lock: what they run is the core's.
class OwnThreads : public LentThreads {
public:
	/// `count` threads besides the calling one.
	explicit OwnThreads(std::size_t count) : count_(count) {}

	/// As many as the machine has cores, but the one that the calling thread has.
	static std::size_t spare() { return std::max(std::thread::hardware_concurrency(), 1u) - 1; }

	std::size_t count() const override { return count_; }

	/// Where the system gives no more threads, those that there are do it.
	void run(const std::function<void(std::size_t index)> &work) override {
		std::vector<std::jthread> threads; // Waits for all of them in the end.
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
