#include "nodes/common/guard.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/char_string.hpp>
#include <godot_cpp/variant/string.hpp>

#include <deque>
#include <new>
#include <stdexcept>
#include <string>

using namespace godot;

namespace thicket {

namespace {

/// Formats an argument for an error message. Values that may be long become "...".
String abbreviated(const Variant &p_value) {
	switch (p_value.get_type()) {
		case Variant::NIL:
		case Variant::BOOL:
		case Variant::INT:
		case Variant::FLOAT:
		case Variant::VECTOR2:
		case Variant::VECTOR3:
		case Variant::RECT2:
		case Variant::RECT2I: return vformat("%s", p_value);
		default: return "...";
	}
}

const char *exception_reason() {
	try {
		throw;
	} catch (const std::bad_alloc &) {
		return "needs more memory than is available";
	} catch (const std::length_error &) {
		return "needs more memory than is available";
	} catch (...) {
		return "failed because of an internal error";
	}
}

} // namespace

const char *permanent_method_name(const StringName &p_class, const StringName &p_method) {
	static std::deque<std::string> names; // A deque never moves its strings.
	return names.emplace_back((String(p_class) + "." + String(p_method)).utf8().get_data()).c_str();
}

void report_failed_call(const char *method, std::span<const Variant> arguments) noexcept {
	const char *reason = exception_reason();
	try {
		String list;
		for (const Variant &argument : arguments) {
			list = list + (list.is_empty() ? "" : ", ") + abbreviated(argument);
		}
		ERR_PRINT(vformat("%s(%s) %s", String(method), list, String(reason)));
	} catch (...) {
		ERR_PRINT(reason); // There is not enough memory for a longer message.
	}
}

} // namespace thicket
