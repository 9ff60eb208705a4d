#pragma once

// This file defines the exception boundary between our code and the engine. Exceptions must not
// cross it, because the engine would terminate. The core converts its own exceptions to a Status
// (core/base/guard.hpp). This file covers all other code that allocates memory in bound methods,
// notifications and worker tasks.

#include "nodes/common/main_calls.hpp"
#include "nodes/common/thread_rule.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

namespace thicket {

/// Prints an error for a call that ended with an exception: the method (`Class.method`), its
/// arguments and the reason. Call it inside a catch block.
void report_failed_call(const char *method, std::span<const godot::Variant> arguments) noexcept;

/// Runs the body of a notification or virtual method that the engine called. If it throws, prints
/// an error that names `method` and returns a default value, such as 0 or an empty array.
template <typename Work>
std::invoke_result_t<Work> guarded_call(const char *method, Work &&work) {
	try {
		return std::forward<Work>(work)();
	} catch (...) {
		report_failed_call(method, {});
	}
	return std::invoke_result_t<Work>();
}

/// The class, the result and the parameters of a member function.
template <typename Method>
struct MemberFunction;

template <typename C, typename R, typename... Args>
struct MemberFunction<R (C::*)(Args...)> {
	using Class = C;

	/// The method that is bound in place of `method`. It has the same signature and calls `method`
	/// inside a guard that catches exceptions. THICKET_GUARDED_METHODS defines it.
	template <auto method>
	static constexpr R (C::*entry)(Args...) = &C::template guarded_entry<method, R, Args...>;
};

template <typename C, typename R, typename... Args>
struct MemberFunction<R (C::*)(Args...) const> {
	using Class = C;

	template <auto method>
	static constexpr R (C::*entry)(Args...) const = &C::template guarded_const_entry<method, R, Args...>;
};

/// Returns `Class.method` as a string that stays valid until the library is unloaded.
const char *permanent_method_name(const godot::StringName &p_class, const godot::StringName &p_method);

/// The name and thread rule of a bound method. The name is a plain pointer, because hundreds of
/// std::string variables would each register a destructor.
template <auto method>
inline BoundMethod bound_method;

/// Returns the ThreadGuard of an object; null if all methods of its class may be called on any
/// thread.
template <typename Self>
ThreadGuard *thread_guard_of(Self *p_self) {
	if constexpr (requires { p_self->thread_guard(); }) {
		return &p_self->thread_guard();
	} else {
		return nullptr;
	}
}

template <typename R>
struct RefTarget {
	using Type = void;
};

template <typename T>
struct RefTarget<godot::Ref<T>> {
	using Type = T;
};

/// Returns the result of a rejected call: a default value, such as 0 or an empty array.
template <typename R>
R rejected_result(godot::Error error) {
	if constexpr (std::is_same_v<R, godot::Error>) {
		return error; // The default value of Error means success.
	} else if constexpr (requires { RefTarget<R>::Type::make_empty(); }) {
		return RefTarget<R>::Type::make_empty(); // The class reference documents an empty object, not null.
	} else {
		return R();
	}
}

/// Converts an argument for an error message. Types that a Variant cannot store become null.
template <typename T>
godot::Variant argument_of(const T &p_argument) {
	if constexpr (std::is_enum_v<T>) {
		return godot::Variant(static_cast<int64_t>(p_argument));
	} else if constexpr (std::is_constructible_v<godot::Variant, const T &>) {
		return godot::Variant(p_argument);
	} else {
		return godot::Variant();
	}
}

/// Calls a bound method if its thread rule permits the calling thread. Otherwise queues the call
/// for the main thread (ThreadUse::relayed) or prints an error. If the method throws, prints an
/// error with its name and arguments.
template <auto method, typename R, typename Self, typename... Args>
R call_guarded(Self *p_self, const Args &...p_arguments) {
	const BoundMethod &bound = bound_method<method>;
	const ThreadTurn turn(thread_guard_of(p_self), bound, std::is_const_v<Self>);
	if (!turn.is_granted()) {
		if (bound.rule.use == ThreadUse::relayed) {
			const std::array<godot::Variant, sizeof...(Args)> arguments{argument_of(p_arguments)...};
			call_on_main_thread(p_self, bound.name, arguments);
		} else {
			turn.report();
		}
		return rejected_result<R>(godot::ERR_BUSY);
	}
	try {
		return (p_self->*method)(p_arguments...);
	} catch (...) {
		const std::array<godot::Variant, sizeof...(Args)> arguments{argument_of(p_arguments)...};
		report_failed_call(bound.name, arguments);
	}
	return rejected_result<R>(godot::ERR_OUT_OF_MEMORY);
}

/// Binds a method like ClassDB::bind_method, with a thread rule and protection against exceptions:
/// `bind_guarded<&ScatterRequest::cancel>(ThreadUse::any, D_METHOD("cancel"))`. The class must use
/// THICKET_GUARDED_METHODS.
template <auto method, typename Definition, typename... Defaults>
void bind_guarded(const ThreadRule &rule, const Definition &p_definition, const Defaults &...p_defaults) {
	using Member = MemberFunction<decltype(method)>;
	bound_method<method> = {permanent_method_name(Member::Class::get_class_static(), p_definition.name), rule};
	godot::ClassDB::bind_method(p_definition, Member::template entry<method>, p_defaults...);
}

/// Binds a method with the default thread rule of its class.
template <auto method, typename Definition, typename... Defaults>
	requires(!std::is_convertible_v<Definition, ThreadRule>)
void bind_guarded(const Definition &p_definition, const Defaults &...p_defaults) {
	bind_guarded<method>(MemberFunction<decltype(method)>::Class::thread_rule(), p_definition, p_defaults...);
}

} // namespace thicket

/// Required, after GDCLASS, in each class whose methods are bound with bind_guarded. Sets the
/// default thread rule and adds the guarded methods that the engine calls. The guarded methods are
/// members of the class because godot-cpp can only bind members. A class with any rule other than
/// ThreadUse::any must also derive from ThreadGuarded.
#define THICKET_GUARDED_METHODS(m_use) \
	template <typename> \
	friend struct ::thicket::MemberFunction; \
	template <auto method, typename R, typename... Args> \
	R guarded_entry(Args... p_arguments) { \
		return ::thicket::call_guarded<method, R>(this, p_arguments...); \
	} \
	template <auto method, typename R, typename... Args> \
	R guarded_const_entry(Args... p_arguments) const { \
		return ::thicket::call_guarded<method, R>(this, p_arguments...); \
	} \
\
public: \
	static constexpr ::thicket::ThreadRule thread_rule() { return ::thicket::ThreadUse::m_use; } \
\
private:
