#pragma once

#include "core/base/caller_threads.hpp"

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace thicket::test {

/// Worker threads for tests. `runs` counts the calls of `run`.
class CountedThreads final : public CallerThreads {
public:
	explicit CountedThreads(std::size_t count) : count_(count) {}

	std::size_t count() const override { return count_; }

	void run(const std::function<void(std::size_t)> &work) override {
		++runs;
		std::vector<std::jthread> threads;
		for (std::size_t index = 1; index <= count_; ++index) {
			threads.emplace_back(work, index);
		}
		work(0);
	}

	int runs = 0;

private:
	std::size_t count_;
};

} // namespace thicket::test
