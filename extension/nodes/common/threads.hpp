#pragma once

#include "core/base/caller_threads.hpp"

#include <cstddef>
#include <functional>

namespace thicket {

/// Returns true if the engine has worker threads. Web builds may have none, and projects can
/// disable them.
bool has_threads();

/// Records the calling thread as the engine's main thread. Call it once, before registering
/// classes.
void remember_main_thread();

/// Returns true on the engine's main thread. Takes a few nanoseconds. Does not call the engine,
/// because that could allocate memory for a wrapper object.
bool on_main_thread() noexcept;

/// Returns the number of worker threads to use in addition to the calling thread, 0 to 8.
std::size_t spare_thread_count();

/// Lends threads of the engine's WorkerThreadPool to the core. Usable on any thread.
class EngineThreads final : public CallerThreads {
public:
	std::size_t count() const override { return count_; }
	void run(const std::function<void(std::size_t index)> &work) override;

private:
	std::size_t count_ = spare_thread_count();
};

} // namespace thicket
