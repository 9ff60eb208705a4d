#pragma once

#include <shared_mutex>

namespace thicket {

/// Lets any number of threads call an object, and one of them wait until no other thread does. Calls may nest: a thread that
/// is inside of this gate or of others may enter again.
class CallGate {
public:
	/// While one lives, its thread is inside. To be made and destroyed like a variable of a function: the last one first.
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
		const Inside *outer_; ///< Of the same thread, of any gate.
		bool first_;          ///< Of its thread in this gate.
		static inline thread_local const Inside *innermost_ = nullptr;
	};

	/// Does something while no other thread is inside. Does not wait for the calls that the calling thread is within itself.
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
	/// Whether the calling thread is.
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
