#pragma once

#include "core/base/lent_threads.hpp"

#include <cstddef>
#include <functional>

namespace thicket {

/// Whether the engine has worker threads. Web builds may have none, and a project may disable them.
bool has_threads();

/// The caller is the engine's main thread. To be called once, before any class is registered.
void remember_main_thread();

/// Whether the caller runs on the engine's main thread. Costs a few nanoseconds, and calls nothing of the engine: that could need
/// memory, for a wrapper.
bool on_main_thread() noexcept;

/// The number of threads to use besides the calling one: 0 to 8.
std::size_t spare_thread_count();

/// Threads of the engine's WorkerThreadPool, for a call that may be made on any thread.
class EngineThreads final : public LentThreads {
public:
	std::size_t count() const override { return count_; }
	void run(const std::function<void(std::size_t index)> &work) override;

private:
	std::size_t count_ = spare_thread_count();
};

} // namespace thicket
