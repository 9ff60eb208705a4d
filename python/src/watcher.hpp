#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <string>

namespace thicket::python {

/// Cancels calls on any thread. An object that was canceled stays canceled.
class Cancel {
public:
	void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
	bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

private:
	std::atomic<bool> cancelled_ = false;
};

/// Raised in Python when a Cancel has ended a call.
class Cancelled : public std::exception {
public:
	explicit Cancelled(std::string text) : text_(std::move(text)) {}
	const char *what() const noexcept override { return text_.c_str(); }

private:
	std::string text_;
};

/// Watches one call that runs without the interpreter's lock. About every 15 milliseconds, it takes
/// the lock to call the progress function and to check for Ctrl+C. If either raises an exception,
/// or if the Cancel is canceled, it ends the call.
class Watcher {
public:
	/// Creates a watcher. `callback` is a callable or None, and `cancel` may be null. The caller
	/// must hold the interpreter's lock, as for all members except the functions of `progress`.
	Watcher(nanobind::object callback, const Cancel *cancel);

	/// Returns the functions that a sampler calls. The watcher must outlive them.
	Progress progress();

	/// Raises the exception of the progress function, or Cancelled. For any other error, raises
	/// ValueError or MemoryError with `message`, which the core wrote. If there is no error, reports
	/// to the progress function that all `points` are done, and passes on its exception.
	void finish(const Status &status, const std::string &message, std::uint64_t points);

private:
	using Clock = std::chrono::steady_clock;

	void update(double fraction, std::uint64_t points);
	void report(double fraction, std::uint64_t points);

	nanobind::object callback_;
	const Cancel *cancel_;
	std::atomic<bool> ended_ = false;
	std::exception_ptr raised_;
	double fraction_ = 0.0; ///< The last reported fraction.
	Clock::time_point due_; ///< Time at which to take the interpreter's lock again.
};

} // namespace thicket::python
