#pragma once

#include "core/base/lent_threads.hpp"

#include <cstddef>
#include <functional>

namespace thicket {

/// Whether the engine has worker threads. Web builds may have none, and a project may disable them.
bool has_threads();

/// Records that the caller is the engine's main thread. Call it once, before any class is registered.
void remember_main_thread();

/// True if the caller runs on the engine's main thread. Costs a few nanoseconds. Does not call the engine, because that
/// could allocate memory for a wrapper.
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
