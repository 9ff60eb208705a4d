#pragma once

#include "core/base/mutex.hpp"
#include "core/base/status.hpp"
#include "nodes/common/script_call.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string.hpp>

#include <concepts>
#include <cstdint>

namespace thicket {

/// A method of a ground script or a rule script, and the value that it must return.
struct ScriptMethod {
	const char *name;
	const char *result;                ///< Names the array in errors about its size.
	const char *elements;              ///< Names the array in errors about its type.
	const char *expected;              ///< Describes the required value for users.
	godot::Variant::Type element_type; ///< FLOAT also accepts integers.
};

/// Calls the methods of a script, checks their results, and describes the last rejected
/// result in a message. Any thread may use this class.
class ScriptAnswers {
public:
	/// Calls a method of `p_owner`, which must return `count` elements. If the result is invalid,
	/// returns an error and clears `r_answer`.
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

	/// Records and returns `status`, the error of a method whose result was rejected.
	/// `p_description` describes the result: "returned -1".
	Status reject(godot::Object *p_owner, const ScriptMethod &method, const Status &status,
			const godot::String &p_description);

	/// Returns a message with the script, the method, the actual and the expected result, and how
	/// to fix it. Returns an empty string unless `status` is from the last rejected result.
	godot::String sentence(const Status &status) const;

private:
	Status check(godot::Object *p_owner, const ScriptMethod &method, GDExtensionCallErrorType error,
			const godot::Variant &p_answer, std::int64_t count);

	mutable Mutex mutex_;
	godot::String sentence_;
	Status last_rejection_;
};

/// Returns the global name of an object's script, or its file, or the object's class.
godot::String short_script_name(godot::Object *p_owner);

} // namespace thicket
