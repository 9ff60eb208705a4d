#pragma once

#include "core/base/mutex.hpp"
#include "core/base/status.hpp"
#include "nodes/common/script_call.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string.hpp>

#include <concepts>
#include <cstdint>

namespace thicket {

/// A method of a ground script, and the array that it must return.
struct ScriptMethod {
	const char *name;
	const char *result;                ///< The array's name in errors.
	const char *elements;              ///< The array's name in errors about other types.
	const char *expected;              ///< A description of the array, for the user.
	godot::Variant::Type element_type; ///< FLOAT also accepts integers.
};

/// Checks the results of a ground script's methods, and describes the last refused result in a sentence. Any thread.
class ScriptAnswers {
public:
	/// Calls a method of `owner`, which must return `count` elements. If the result is refused, `r_answer` is empty.
	template <class Packed>
	Status call(godot::Object *p_owner, const ScriptMethod &method, std::int64_t count, Packed &r_answer,
			const std::same_as<godot::Variant> auto &...p_arguments) {
		godot::Variant owner(p_owner);
		godot::Variant answer;
		const GDExtensionCallErrorType error = call_script(owner, method.name, answer, p_arguments...);
		const Status status = check(p_owner, method, error, answer, count);
		const Packed packed = status.ok() ? answer : godot::Variant(Packed());
		r_answer = packed;
		return status;
	}

	/// Names the script, the method, the result, the expected result and the remedy. Empty if `status` does not belong
	/// to the last refusal.
	godot::String sentence(const Status &status) const;

private:
	Status check(godot::Object *p_owner, const ScriptMethod &method, GDExtensionCallErrorType error,
			const godot::Variant &p_answer, std::int64_t count);

	mutable Mutex mutex_;
	godot::String sentence_;
	Status refusal_;
};

} // namespace thicket
