#include "nodes/common/script_answer.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <algorithm>
#include <mutex>
#include <optional>

using namespace godot;

namespace thicket {

namespace {

bool is_element(const Variant &p_value, Variant::Type type) {
	return p_value.get_type() == type || (type == Variant::FLOAT && p_value.get_type() == Variant::INT);
}

template <class Packed>
std::int64_t size_of(const Variant &p_array) {
	const Packed packed = p_array;
	return packed.size();
}

/// Returns the size of a result that is an array convertible to the expected type; -1 for any other
/// result.
std::int64_t count_of(const Variant &p_answer, Variant::Type element_type) {
	switch (p_answer.get_type()) {
		case Variant::ARRAY: {
			const Array array = p_answer;
			for (std::int64_t index = 0; index < array.size(); ++index) {
				if (!is_element(array[index], element_type)) {
					return -1;
				}
			}
			return array.size();
		}
		case Variant::PACKED_INT32_ARRAY:
		case Variant::PACKED_INT64_ARRAY:
		case Variant::PACKED_FLOAT32_ARRAY:
		case Variant::PACKED_FLOAT64_ARRAY:
			return element_type == Variant::FLOAT ? size_of<PackedFloat32Array>(p_answer) : -1;
		case Variant::PACKED_VECTOR3_ARRAY:
			return element_type == Variant::VECTOR3 ? size_of<PackedVector3Array>(p_answer) : -1;
		default: return -1;
	}
}

/// The global name and the file of an object's script. Both are empty for an inner class.
struct ScriptNames {
	String name;
	String path;
};

/// Returns no value for an object without a script.
std::optional<ScriptNames> script_names(Object *p_owner) {
	const Variant script = p_owner->get("script");
	Object *object = script.get_validated_object();
	if (object == nullptr) {
		return std::nullopt;
	}
	return ScriptNames{object->call("get_global_name"), object->get("resource_path")};
}

/// Returns the name of an object's script: its global name and file. For an inner class, returns a
/// description with the object's class.
String script_name(Object *p_owner) {
	const std::optional<ScriptNames> names = script_names(p_owner);
	if (!names) {
		return p_owner->get_class();
	}
	const auto &[name, path] = *names;
	const String text = name.is_empty() ? path : path.is_empty() ? name : name + String(" (") + path + String(")");
	return text.is_empty() ? p_owner->get_class() + String(" with an inner class as its script")
						   : String("Script ") + text + String(" of ") + p_owner->get_class();
}

String describe_answer(GDExtensionCallErrorType error, const Variant &p_answer, std::int64_t size, std::int64_t count) {
	if (error != GDEXTENSION_CALL_OK) {
		return "could not be called";
	}
	const bool is_empty = size == 0 || p_answer.get_type() == Variant::NIL;
	if (is_empty) {
		return String("returned ") + (size == 0 ? "an empty array" : "null") + String(" for ") +
				String::num_int64(count) + String(" positions, as it does after a script error");
	}
	if (size > 0) {
		return String("returned ") + String::num_int64(size) + String(" elements for ") + String::num_int64(count) +
				String(" positions");
	}
	return p_answer.get_type() >= Variant::ARRAY ? String("returned an array with elements of the wrong type")
												 : vformat("returned \"%s\"", p_answer);
}

} // namespace

String short_script_name(Object *p_owner) {
	const ScriptNames names = script_names(p_owner).value_or(ScriptNames());
	return !names.name.is_empty() ? names.name : names.path.is_empty() ? p_owner->get_class() : names.path.get_file();
}

Status ScriptAnswers::check(Object *p_owner, const ScriptMethod &method, GDExtensionCallErrorType error,
		const Variant &p_answer, std::int64_t count) {
	const std::int64_t size = error == GDEXTENSION_CALL_OK ? count_of(p_answer, method.element_type) : -1;
	if (size == count) {
		return {};
	}
	const bool is_array = size >= 0 || p_answer.get_type() == Variant::NIL;
	const Status status = is_array
			? Status::wrong_size(method.result, std::max<std::int64_t>(size, 0), exactly(count, "one per position"))
			: Status::missing(method.elements, "Return one element for each position");
	return reject(p_owner, method, status, describe_answer(error, p_answer, size, count));
}

Status ScriptAnswers::reject(
		Object *p_owner, const ScriptMethod &method, const Status &status, const String &p_description) {
	const String text = script_name(p_owner) + String(": ") + String(method.name) + String("() ") + p_description +
			String(". It must return ") + String(method.expected) +
			String(". Fix the method, then call TerrainScatter3D.regenerate().");
	const std::lock_guard lock(mutex_);
	last_rejection_ = status;
	sentence_ = text;
	return status;
}

String ScriptAnswers::sentence(const Status &status) const {
	const std::lock_guard lock(mutex_);
	const bool is_last =
			!status.ok() && last_rejection_.code == status.code && last_rejection_.property == status.property;
	return is_last ? sentence_ : String();
}

} // namespace thicket
