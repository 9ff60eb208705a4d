#pragma once

#include <shared_mutex>

namespace thicket {

/// Lets any number of threads call an object, and lets one thread wait until no other thread is
/// inside such a call. Recursive: a thread that is inside this gate or another one may enter again.
class CallGate {
public:
	/// Keeps the current thread inside the gate during its lifetime. Use it only as a local
	/// variable, because instances must be destroyed in reverse order of their creation.
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
		const Inside *outer_; ///< This thread's enclosing Inside, of any gate.
		bool first_;          ///< True for the thread's outermost Inside of this gate.
		static inline thread_local const Inside *innermost_ = nullptr;
	};

	/// Waits until no other thread is inside the gate and runs `act`. Other threads that enter wait
	/// until `act` returns. If the calling thread is inside the gate, it leaves temporarily so that
	/// it does not wait for itself.
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
	/// Returns true if the calling thread is inside.
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
