#pragma once

// Defines which threads may call a bound method. Most methods have the rule of their class; the others declare a rule
// at their binding. call_guarded (guard.hpp) checks it before the method runs.

#include <atomic>
#include <cstdint>

namespace thicket {

enum class ThreadUse : std::uint8_t {
	/// Any thread, also several at the same time.
	any,

	/// The main thread only.
	main,

	/// Any thread, one at a time (const methods: several). While the scene tree uses the object, only the main thread.
	/// So a loader may fill an object that nothing uses yet. No other thread changes an object that the main thread
	/// reads in its frames.
	owner,

	/// As `owner`, but the main thread makes a refused call in its next frame. For signal handlers, because any thread may emit a signal.
	relayed,
};

struct ThreadRule {
	constexpr ThreadRule(ThreadUse allowed, const char *instead = nullptr) :
			use(allowed), remedy(instead) {} // NOLINT: as an argument

	ThreadUse use;
	const char *remedy; ///< A sentence for the error: what other threads can do instead. Null for the default sentence.
};

/// A bound method.
struct BoundMethod {
	const char *name = ""; ///< `Class.method`
	ThreadRule rule = ThreadUse::any;
};

class ThreadTurn;

/// Keeps track of the threads that are inside methods of an object, and of whether the scene tree uses it.
class ThreadGuard {
public:
	ThreadGuard() = default;
	~ThreadGuard();
	ThreadGuard(const ThreadGuard &) = delete;
	ThreadGuard &operator=(const ThreadGuard &) = delete;

	/// From this call on, the main thread uses the object in its frames and queries; `leave_scene` undoes one call. If
	/// another thread is inside one of the object's methods, waits at most one second for it to leave. Returns false if
	/// that takes longer.
	bool enter_scene();
	void leave_scene() { scene_uses_.fetch_sub(1); }
	bool in_scene() const { return scene_uses_.load() > 0; }

private:
	friend class ThreadTurn;

	static constexpr std::int32_t writing = -1;

	std::atomic<std::int32_t> scene_uses_ = 0;
	std::atomic<std::int32_t> calls_ = 0; ///< The threads in const methods, or `writing` for one in any other method.
};

/// The second base, after the engine's, of each class whose methods use the rules `main`, `owner` or `relayed`.
class ThreadGuarded {
public:
	ThreadGuard &thread_guard() const { return thread_guard_; }

protected:
	ThreadGuarded() = default;
	~ThreadGuarded() = default;

private:
	mutable ThreadGuard thread_guard_;
};

/// One call of a method, from its check to its end. Its callbacks may call methods of the same object and may free it.
class ThreadTurn {
public:
	/// `guard` is null for an object whose methods all have the rule `any`. `reads` is true for a const method.
	ThreadTurn(ThreadGuard *guard, const BoundMethod &method, bool reads) noexcept;
	~ThreadTurn();
	ThreadTurn(const ThreadTurn &) = delete;
	ThreadTurn &operator=(const ThreadTurn &) = delete;

	bool granted() const { return refusal_ == Refusal::none; }

	/// Prints why the call was refused, and what to do instead.
	void report() const;

private:
	friend class ThreadGuard;

	enum class Refusal : std::uint8_t { none, not_main, in_scene, busy };

	static bool held_by_this_thread(const ThreadGuard &guard, bool &r_written);
	bool take(bool reads);
	void release();

	const BoundMethod &method_;
	ThreadGuard *guard_ = nullptr; ///< Null if nothing was taken, or the object has been freed.
	std::int32_t before_ = 0;      ///< The value of ThreadGuard::calls_ before this turn replaced it with `writing`.
	bool reads_ = false;
	Refusal refusal_ = Refusal::none;
	ThreadTurn *outer_ = nullptr; ///< The turn of this thread inside which this one was taken.
};

} // namespace thicket
