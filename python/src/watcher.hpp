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

/// What ends calls from other threads. Once raised it stays so.
class Cancel {
public:
	void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
	bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

private:
	std::atomic<bool> cancelled_ = false;
};

/// Raised in Python where a Cancel ended a call.
class Cancelled : public std::exception {
public:
	explicit Cancelled(std::string text) : text_(std::move(text)) {}
	const char *what() const noexcept override { return text_.c_str(); }

private:
	std::string text_;
};

/// Watches one call that runs without the interpreter's lock: takes it about every 15 milliseconds, for the progress function and for
/// Ctrl+C, and ends the call where one of both raises an exception, or the Cancel is raised.
class Watcher {
public:
	/// `callback` is a callable or None, `cancel` may be null. With the lock, as all but `progress`'s own functions.
	Watcher(nanobind::object callback, const Cancel *cancel);

	/// What a sampler tells, for as long as this object lives.
	Progress progress();

	/// Raises what ended the call: what the progress function raised, or Cancelled, or a status as ValueError or MemoryError, with the
	/// core's `sentence`. Otherwise tells the progress function that all `points` are there; where that raises, so does this.
	void finish(const Status &status, const std::string &sentence, std::uint64_t points);

private:
	using Clock = std::chrono::steady_clock;

	void update(double fraction, std::uint64_t points);
	void tell(double fraction, std::uint64_t points);

	nanobind::object callback_;
	const Cancel *cancel_;
	std::atomic<bool> ended_ = false;
	std::exception_ptr raised_;
	double fraction_ = 0.0; ///< The last one that was told.
	Clock::time_point due_; ///< When it is time to take the lock again.
};

} // namespace thicket::python
