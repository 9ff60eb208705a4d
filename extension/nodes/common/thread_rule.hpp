#pragma once

// This file defines which threads may call a bound method. Most methods use the default rule of
// their class. All other methods specify a rule when they are bound. call_guarded (guard.hpp)
// enforces the rule.

#include <atomic>
#include <cstdint>

namespace thicket {

enum class ThreadUse : std::uint8_t {
	/// Any number of threads may call the method concurrently.
	any,

	/// Only the main thread may call the method.
	main,

	/// Any thread may call the method, but only one at a time. Several threads may run const
	/// methods concurrently. While the scene tree uses the object, only the main thread may call
	/// the method. A loader thread can therefore fill an object before it is in use, and no thread
	/// modifies objects that the main thread reads every frame.
	owner,

	/// Like `owner`, but a rejected call is queued for the next frame on the main thread. Signal
	/// handlers use this rule, because any thread may emit a signal.
	relayed,
};

struct ThreadRule {
	constexpr ThreadRule(ThreadUse p_use, const char *p_remedy = nullptr) :
			use(p_use), remedy(p_remedy) {} // NOLINT: as an argument

	ThreadUse use;
	/// The part of the error message that suggests an alternative. Null selects the default text.
	const char *remedy;
};

/// The name and rule of a bound method.
struct BoundMethod {
	const char *name = ""; ///< `Class.method`
	ThreadRule rule = ThreadUse::any;
};

class ThreadTurn;

/// Tracks which threads are inside methods of an object, and whether the scene tree uses the
/// object.
class ThreadGuard {
public:
	ThreadGuard() = default;
	~ThreadGuard();
	ThreadGuard(const ThreadGuard &) = delete;
	ThreadGuard &operator=(const ThreadGuard &) = delete;

	/// Marks the object as used by the scene tree until the matching call to `leave_scene`. If
	/// another thread is inside one of the object's methods, waits up to one second for it to
	/// leave. Returns false if it does not.
	bool enter_scene();
	void leave_scene() { scene_uses_.fetch_sub(1); }
	bool in_scene() const { return scene_uses_.load() > 0; }

private:
	friend class ThreadTurn;

	static constexpr std::int32_t writing = -1;

	std::atomic<std::int32_t> scene_uses_ = 0;
	/// The number of calls to const methods in progress, or `writing` during a call to any other
	/// method.
	std::atomic<std::int32_t> calls_ = 0;
};

/// The base class, in addition to the engine's, of classes whose methods use the rules `main`,
/// `owner` or `relayed`.
class ThreadGuarded {
public:
	ThreadGuard &thread_guard() const { return thread_guard_; }

protected:
	ThreadGuarded() = default;
	~ThreadGuarded() = default;

private:
	mutable ThreadGuard thread_guard_;
};

/// The scope of one call to a bound method. Checks the thread rule when it begins. Callbacks of the
/// method may call other methods of the object and may free it.
class ThreadTurn {
public:
	/// `guard` is null if all methods of the class have the rule `any`. `reads` is true for const
	/// methods.
	ThreadTurn(ThreadGuard *guard, const BoundMethod &method, bool reads) noexcept;
	~ThreadTurn();
	ThreadTurn(const ThreadTurn &) = delete;
	ThreadTurn &operator=(const ThreadTurn &) = delete;

	bool is_granted() const { return rejection_ == Rejection::none; }

	/// Prints why the call was rejected and how to fix it.
	void report() const;

private:
	friend class ThreadGuard;

	enum class Rejection : std::uint8_t { none, not_main, in_scene, busy };

	static bool is_held_by_this_thread(const ThreadGuard &guard, bool &r_is_writing);
	bool take(bool reads);
	void release();

	const BoundMethod &method_;
	/// The guard of the object. Null if no turn was taken, or if the object has been freed.
	ThreadGuard *guard_ = nullptr;
	std::int32_t previous_calls_ = 0; ///< The value of ThreadGuard::calls_ to restore after `writing`.
	bool reads_ = false;
	Rejection rejection_ = Rejection::none;
	ThreadTurn *outer_turn_ = nullptr; ///< The enclosing turn of this thread.
};

} // namespace thicket
