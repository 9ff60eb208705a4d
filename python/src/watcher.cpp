#include "watcher.hpp"

#include <algorithm>
#include <utility>

namespace nb = nanobind;

namespace thicket::python {

namespace {

/// The intervals between calls to the interpreter, with and without a progress function. Taking the
/// interpreter's lock is slow if another thread runs: Python hands the lock over only every 5
/// milliseconds.
constexpr std::chrono::milliseconds pause_with_progress{15};
constexpr std::chrono::milliseconds pause_without_progress{100};

} // namespace

Watcher::Watcher(nb::object callback, const Cancel *cancel) :
		callback_(std::move(callback)), cancel_(cancel), due_(Clock::now() + pause_with_progress) {
	if (cancel_ != nullptr && cancel_->cancelled()) {
		ended_.store(true, std::memory_order_relaxed);
	}
}

Progress Watcher::progress() {
	return {&ended_, [this](double fraction, std::uint64_t points) { update(fraction, points); }};
}

void Watcher::update(double fraction, std::uint64_t points) {
	if (cancel_ != nullptr && cancel_->cancelled()) {
		ended_.store(true, std::memory_order_relaxed);
	}
	if (ended_.load(std::memory_order_relaxed) || fraction >= 1.0 || Clock::now() < due_) {
		return;
	}
	const nb::gil_scoped_acquire lock;
	try {
		if (PyErr_CheckSignals() != 0) {
			throw nb::python_error();
		}
		fraction_ = std::max(fraction_, fraction);
		report(fraction_, points);
	} catch (...) {
		raised_ = std::current_exception();
		ended_.store(true, std::memory_order_relaxed);
	}
	due_ = Clock::now() + (callback_.is_none() ? pause_without_progress : pause_with_progress);
}

void Watcher::report(double fraction, std::uint64_t points) {
	if (!callback_.is_none()) {
		callback_(fraction, points);
	}
}

void Watcher::finish(const Status &status, const std::string &message, std::uint64_t points) {
	if (raised_) {
		std::rethrow_exception(std::exchange(raised_, nullptr));
	}
	if (status.code == ErrorCode::cancelled) {
		throw Cancelled(message);
	}
	if (!status.ok()) {
		PyErr_SetString(
				status.code == ErrorCode::out_of_memory ? PyExc_MemoryError : PyExc_ValueError, message.c_str());
		throw nb::python_error();
	}
	report(1.0, points);
}

} // namespace thicket::python
