#pragma once

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <vector>

namespace godot {

/// The description of a property, an argument or a result for the inspector and for scripts.
struct PropertyInfo {
	Variant::Type type = Variant::NIL;
	StringName name;
	StringName class_name;
	uint32_t hint = PROPERTY_HINT_NONE;
	String hint_string;
	uint32_t usage = PROPERTY_USAGE_DEFAULT;

	PropertyInfo() = default;
	PropertyInfo(Variant::Type p_type, const StringName &p_name, PropertyHint p_hint = PROPERTY_HINT_NONE,
			const String &p_hint_string = String(), uint32_t p_usage = PROPERTY_USAGE_DEFAULT,
			const StringName &p_class_name = StringName());

	explicit PropertyInfo(const GDExtensionPropertyInfo *p_info);

	/// Overwrites a property description in the engine's memory.
	void _update(GDExtensionPropertyInfo *p_info) const;

	/// Returns a view for interface functions. The PropertyInfo must outlive the view.
	GDExtensionPropertyInfo _native() const;
};

/// The description of a signal, or of a method that scripts may override.
struct MethodInfo {
	StringName name;
	PropertyInfo return_val;
	uint32_t flags = METHOD_FLAG_NORMAL;
	std::vector<PropertyInfo> arguments;
	GDExtensionClassMethodArgumentMetadata return_val_metadata = GDEXTENSION_METHOD_ARGUMENT_METADATA_NONE;
	std::vector<GDExtensionClassMethodArgumentMetadata> arguments_metadata;

	template <typename... Args>
	explicit MethodInfo(const StringName &p_name, const Args &...p_arguments) :
			name(p_name), arguments{p_arguments...} {}
};

} // namespace godot
