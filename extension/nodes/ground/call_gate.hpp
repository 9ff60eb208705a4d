#pragma once

#include <shared_mutex>

namespace thicket {

/// Lets any number of threads call an object, and lets one thread wait until no other thread is in such a call. Calls
/// may nest: a thread that is inside this gate or others may enter again.
class CallGate {
public:
	/// The thread that created this is inside the gate until it is destroyed. Use it as a local variable: the last one
	/// created must be destroyed first.
	class Inside {
	public:
		explicit Inside(const CallGate &gate) : gate_(gate), outer_(innermost_), first_(!gate.is_inside()) {
			if (first_) {
				gate_.mutex_.lock_shared();
			}
			innermost_ = this;
		}
		~Inside() {
			innermost_ = outer_;
			if (first_) {
				gate_.mutex_.unlock_shared();
			}
		}
		Inside(const Inside &) = delete;
		Inside &operator=(const Inside &) = delete;

	private:
		friend class CallGate;
		const CallGate &gate_;
		const Inside *outer_; ///< The enclosing Inside of the same thread, of any gate.
		bool first_;          ///< True if this is the first Inside of its thread in this gate.
		static inline thread_local const Inside *innermost_ = nullptr;
	};

	/// Runs `act` while no other thread is inside the gate. Does not wait for calls of the calling thread itself.
	template <class Act>
	void alone(Act act) const {
		const bool inside = is_inside();
		if (inside) {
			mutex_.unlock_shared();
		}
		mutex_.lock();
		act();
		mutex_.unlock();
		if (inside) {
			mutex_.lock_shared();
		}
	}

private:
	/// Whether the calling thread is inside.
	bool is_inside() const {
		for (const Inside *inside = Inside::innermost_; inside != nullptr; inside = inside->outer_) {
			if (&inside->gate_ == this) {
				return true;
			}
		}
		return false;
	}

	mutable std::shared_mutex mutex_;
};

} // namespace thicket
