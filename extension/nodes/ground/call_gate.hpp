#pragma once

#include <shared_mutex>

namespace thicket {

/// Lets any number of threads call an object, and lets one thread wait until no other thread is
/// inside such a call. Recursive: a thread that is inside this gate or another one may enter again.
class CallGate {
public:
	/// Keeps the current thread inside the gate during its lifetime. Use it only as a local
	/// variable, because instances must be destroyed in reverse order of their creation.
	class Scope {
	public:
		explicit Scope(const CallGate &gate) : gate_(gate), outer_(innermost_), is_outermost_(!gate.is_inside()) {
			if (is_outermost_) {
				gate_.mutex_.lock_shared();
			}
			innermost_ = this;
		}
		~Scope() {
			innermost_ = outer_;
			if (is_outermost_) {
				gate_.mutex_.unlock_shared();
			}
		}
		Scope(const Scope &) = delete;
		Scope &operator=(const Scope &) = delete;

	private:
		friend class CallGate;
		const CallGate &gate_;
		const Scope *outer_; ///< This thread's enclosing scope, of any gate.
		bool is_outermost_;  ///< True for the thread's outermost scope of this gate.
		static inline thread_local const Scope *innermost_ = nullptr;
	};

	/// Waits until no other thread is inside the gate and runs `action`. Other threads that enter
	/// wait until `action` returns. If the calling thread is inside the gate, it leaves temporarily
	/// so that it does not wait for itself.
	template <class Action>
	void run_alone(Action action) const {
		const bool was_inside = is_inside();
		if (was_inside) {
			mutex_.unlock_shared();
		}
		mutex_.lock();
		action();
		mutex_.unlock();
		if (was_inside) {
			mutex_.lock_shared();
		}
	}

private:
	/// Returns true if the calling thread is inside.
	bool is_inside() const {
		for (const Scope *scope = Scope::innermost_; scope != nullptr; scope = scope->outer_) {
			if (&scope->gate_ == this) {
				return true;
			}
		}
		return false;
	}

	mutable std::shared_mutex mutex_;
};

} // namespace thicket
