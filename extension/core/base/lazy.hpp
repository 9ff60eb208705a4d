#pragma once

#include "core/base/mutex.hpp"

#include <atomic>
#include <memory>
#include <mutex>

namespace thicket {

/// A constant that is computed when a thread first needs it. Other threads wait for the result.
template <class T>
class Lazy {
public:
	/// Returns the value. The first call computes it with `make`, which returns a T. If `make`
	/// throws, the next call tries again.
	template <class Make>
	const T &get(const Make &make) const {
		if (const T *ready = ready_.load(std::memory_order_acquire)) {
			return *ready;
		}
		const std::lock_guard lock(mutex_);
		if (value_ == nullptr) {
			value_ = std::make_unique<const T>(make());
			ready_.store(value_.get(), std::memory_order_release);
		}
		return *value_;
	}

private:
	mutable Mutex mutex_;
	mutable std::unique_ptr<const T> value_; ///< Guarded by `mutex_`.
	mutable std::atomic<const T *> ready_{nullptr};
};

} // namespace thicket
