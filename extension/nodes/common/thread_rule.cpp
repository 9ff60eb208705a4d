#include "nodes/common/thread_rule.hpp"

#include "nodes/common/threads.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <chrono>
#include <thread>

using namespace godot;

namespace thicket {

namespace {

/// The innermost ThreadTurn of this thread that has not ended.
constinit thread_local ThreadTurn *innermost_turn = nullptr;

} // namespace

/// If a method is still running, one of its callbacks has freed the object. The turns of this
/// thread must then not access the guard.
ThreadGuard::~ThreadGuard() {
	for (ThreadTurn *turn = innermost_turn; turn != nullptr; turn = turn->outer_turn_) {
		if (turn->guard_ == this) {
			turn->guard_ = nullptr;
		}
	}
}

bool ThreadGuard::enter_scene() {
	scene_uses_.fetch_add(1); // From now on, calls on other threads are rejected.
	bool is_writing = false;
	if (calls_.load() == 0 || ThreadTurn::is_held_by_this_thread(*this, is_writing)) {
		return true;
	}
	const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(1);
	while (calls_.load() != 0) {
		if (std::chrono::steady_clock::now() > deadline) {
			return false;
		}
		std::this_thread::yield();
	}
	return true;
}

bool ThreadTurn::is_held_by_this_thread(const ThreadGuard &guard, bool &r_is_writing) {
	bool is_held = false;
	for (const ThreadTurn *turn = innermost_turn; turn != nullptr; turn = turn->outer_turn_) {
		if (turn->guard_ == &guard) {
			is_held = true;
			r_is_writing = r_is_writing || !turn->reads_;
		}
	}
	return is_held;
}

/// Enters the method. Returns false if another thread is inside a method that excludes this one.
bool ThreadTurn::take(bool reads) {
	bool is_writing = false;
	const bool is_held = is_held_by_this_thread(*guard_, is_writing);
	if (is_held && (is_writing || reads)) {
		guard_ = nullptr; // The outer turn already excludes other threads.
		return true;
	}
	std::int32_t calls = guard_->calls_.load();
	if (reads) {
		while (calls >= 0) {
			if (guard_->calls_.compare_exchange_weak(calls, calls + 1)) {
				return true;
			}
		}
	} else {
		// This thread may be inside a const method whose callback calls this non-const one. In that
		// case, the const call must be the only reader.
		previous_calls_ = is_held ? 1 : 0;
		calls = previous_calls_;
		if (guard_->calls_.compare_exchange_strong(calls, ThreadGuard::writing)) {
			return true;
		}
	}
	guard_ = nullptr;
	return false;
}

void ThreadTurn::release() {
	if (reads_) {
		guard_->calls_.fetch_sub(1);
	} else {
		guard_->calls_.store(previous_calls_);
	}
	guard_ = nullptr;
}

ThreadTurn::ThreadTurn(ThreadGuard *guard, const BoundMethod &method, bool reads) noexcept :
		method_(method), reads_(reads) {
	const ThreadUse use = method.rule.use;
	if (use == ThreadUse::any) {
		return;
	}
	const bool on_main = on_main_thread();
	if (!on_main && (use == ThreadUse::main || guard == nullptr)) {
		rejection_ = Rejection::not_main;
		return;
	}
	if (guard == nullptr) {
		return;
	}
	if (on_main && reads && guard->in_scene()) {
		// No other thread may modify the object while the scene uses it.
		return;
	}
	guard_ = guard;
	if (!take(reads)) {
		rejection_ = !on_main && guard->in_scene() ? Rejection::in_scene : Rejection::busy;
		return;
	}
	if (guard_ == nullptr) {
		return; // Nested inside another turn of this thread.
	}
	// Checked after taking the turn, so that either enter_scene() detects this turn or this turn
	// detects enter_scene().
	if (!on_main && guard->in_scene()) {
		release();
		rejection_ = Rejection::in_scene;
		return;
	}
	outer_turn_ = innermost_turn;
	innermost_turn = this;
}

ThreadTurn::~ThreadTurn() {
	if (innermost_turn == this) {
		innermost_turn = outer_turn_;
	}
	if (guard_ != nullptr) {
		release();
	}
}

void ThreadTurn::report() const {
	const char *problem = "";
	const char *remedy = "";
	switch (rejection_) {
		case Rejection::none: return;
		case Rejection::not_main:
			problem = "called on a worker thread, but only the main thread may call it.";
			remedy = "Use call_deferred().";
			break;
		case Rejection::in_scene:
			problem = "called on a worker thread while the scene tree uses the object: only the main thread may call "
					  "it then.";
			remedy = "Use call_deferred(), or an object that no node in the tree uses.";
			break;
		case Rejection::busy:
			problem = "called while another thread runs a method of the same object; only one thread at a time may "
					  "use it.";
			remedy = "Use one object per thread, or lock a Mutex around the calls.";
			break;
	}
	if (method_.rule.remedy != nullptr && rejection_ != Rejection::busy) {
		remedy = method_.rule.remedy;
	}
	ERR_PRINT(String(method_.name) + String("() ") + String(problem) + String(" ") + String(remedy));
}

} // namespace thicket
