#include <godot_cpp/core/class_db.hpp>

#include <godot_cpp/core/engine_call.hpp>
#include <godot_cpp/core/script_virtual.hpp>
#include <godot_cpp/godot.hpp>

#include <memory>

namespace godot {

using internal::library;

namespace internal {

namespace {

struct Override {
	StringName name;
	uint32_t hash;
	GDExtensionClassCallVirtual call;
};

/// Data that must exist as long as one of our classes is registered.
struct ClassRecord {
	StringName name;
	const ClassRecord *parent = nullptr; ///< Null if the parent is an engine class.
	std::vector<Override> overrides;
	std::vector<std::unique_ptr<MethodBind>> methods;
};

// The records in order of registration, so parents come first. The list changes only during
// registration and unregistration.
std::vector<std::unique_ptr<ClassRecord>> records;

ClassRecord *find_record(const StringName &p_name) {
	for (const std::unique_ptr<ClassRecord> &record : records) {
		if (record->name == p_name) {
			return record.get();
		}
	}
	return nullptr;
}

/// Returns the override of a virtual method, or null. The engine calls this once for each object
/// and method.
GDExtensionClassCallVirtual find_override(void *p_record, GDExtensionConstStringNamePtr p_name, uint32_t p_hash) {
	const StringName &name = *static_cast<const StringName *>(p_name);
	for (auto *record = static_cast<const ClassRecord *>(p_record); record; record = record->parent) {
		for (const Override &override : record->overrides) {
			if (override.hash == p_hash && override.name == name) {
				return override.call;
			}
		}
	}
	return nullptr;
}

std::vector<GDExtensionPropertyInfo> native_infos(const std::vector<PropertyInfo> &p_list) {
	std::vector<GDExtensionPropertyInfo> result;
	for (const PropertyInfo &info : p_list) {
		result.push_back(info._native());
	}
	return result;
}

} // namespace

void add_override(const char *p_name, uint32_t p_hash, GDExtensionClassCallVirtual p_call) {
	records.back()->overrides.push_back({StringName(p_name), p_hash, p_call});
}

EngineMethod::EngineMethod(const char *p_class, const char *p_name, GDExtensionInt p_hash) :
		method_(gdextension_interface::classdb_get_method_bind(
				StringName(p_class)._native_ptr(), StringName(p_name)._native_ptr(), p_hash)),
		class_(p_class), name_(p_name) {}

bool EngineMethod::check() const {
	if (!method_) {
		ERR_PRINT(vformat("This engine has no %s.%s() with the signature that the extension expects.", class_, name_));
	}
	return method_ != nullptr;
}

Variant EngineMethod::run_variants(GodotObject *p_owner, std::initializer_list<Variant> p_values) const {
	Variant result;
	if (check()) {
		std::vector<GDExtensionConstVariantPtr> pointers;
		for (const Variant &value : p_values) {
			pointers.push_back(&value);
		}
		GDExtensionCallError error{};
		gdextension_interface::object_method_bind_call(
				method_, p_owner, pointers.data(), static_cast<GDExtensionInt>(pointers.size()), &result, &error);
	}
	return result;
}

bool has_script_method(GodotObject *p_owner, const StringName &p_name) {
	return gdextension_interface::object_has_script_method(p_owner, p_name._native_ptr());
}

bool call_script_method(GodotObject *p_owner, const StringName &p_name, const Variant *const *p_args,
		std::size_t p_count, Variant &r_result) {
	if (!has_script_method(p_owner, p_name)) {
		return false;
	}
	GDExtensionCallError error{};
	gdextension_interface::object_call_script_method(p_owner, p_name._native_ptr(),
			reinterpret_cast<const GDExtensionConstVariantPtr *>(p_args), static_cast<GDExtensionInt>(p_count),
			&r_result, &error);
	return error.error == GDEXTENSION_CALL_OK;
}

bool take_arguments(const GDExtensionConstVariantPtr *p_args, GDExtensionInt p_count,
		const std::vector<Variant> &p_defaults, std::span<GDExtensionConstVariantPtr> r_values,
		GDExtensionCallError &r_error) {
	const std::size_t expected_count = r_values.size();
	const auto given_count = static_cast<std::size_t>(p_count);
	r_error = {GDEXTENSION_CALL_OK, 0, static_cast<int32_t>(expected_count)};
	if (given_count > expected_count) {
		r_error.error = GDEXTENSION_CALL_ERROR_TOO_MANY_ARGUMENTS;
		return false;
	}
	if (given_count + p_defaults.size() < expected_count) {
		r_error.error = GDEXTENSION_CALL_ERROR_TOO_FEW_ARGUMENTS;
		return false;
	}
	for (std::size_t i = 0; i < expected_count; ++i) {
		r_values[i] = i < given_count ? p_args[i] : &p_defaults[p_defaults.size() - expected_count + i];
	}
	return true;
}

StringName enum_class_name(std::string_view p_cpp_name) {
	const std::size_t last_separator = p_cpp_name.rfind("::");
	const std::size_t class_separator =
			last_separator == std::string_view::npos ? last_separator : p_cpp_name.rfind("::", last_separator - 1);
	std::string name(class_separator == std::string_view::npos ? p_cpp_name : p_cpp_name.substr(class_separator + 2));
	if (const std::string_view engine = "godot::"; name.starts_with(engine)) {
		name.erase(0, engine.size()); // A global enumeration, such as Error.
	}
	if (const std::size_t scope = name.find("::"); scope != std::string::npos) {
		name.replace(scope, 2, 1, '.');
	}
	return StringName(name.c_str());
}

} // namespace internal

using namespace internal;

MethodDefinition define_method(const StringName &p_name, std::initializer_list<const char *> p_arguments) {
	MethodDefinition result{p_name, {}};
	for (const char *name : p_arguments) {
		result.arguments.push_back(StringName(name));
	}
	return result;
}

PropertyInfo::PropertyInfo(Variant::Type p_type, const StringName &p_name, PropertyHint p_hint,
		const String &p_hint_string, uint32_t p_usage, const StringName &p_class_name) :
		type(p_type), name(p_name),
		// The inspector uses the class name to list matching resources.
		class_name(p_hint == PROPERTY_HINT_RESOURCE_TYPE ? StringName(p_hint_string) : p_class_name), hint(p_hint),
		hint_string(p_hint_string), usage(p_usage) {}

PropertyInfo::PropertyInfo(const GDExtensionPropertyInfo *p_info) :
		type(static_cast<Variant::Type>(p_info->type)), name(*static_cast<const StringName *>(p_info->name)),
		class_name(*static_cast<const StringName *>(p_info->class_name)), hint(p_info->hint),
		hint_string(*static_cast<const String *>(p_info->hint_string)), usage(p_info->usage) {}

void PropertyInfo::_update(GDExtensionPropertyInfo *p_info) const {
	p_info->type = static_cast<GDExtensionVariantType>(type);
	*static_cast<StringName *>(p_info->name) = name;
	*static_cast<StringName *>(p_info->class_name) = class_name;
	p_info->hint = hint;
	*static_cast<String *>(p_info->hint_string) = hint_string;
	p_info->usage = usage;
}

GDExtensionPropertyInfo PropertyInfo::_native() const {
	return {static_cast<GDExtensionVariantType>(type), name._native_ptr(), class_name._native_ptr(), hint,
			hint_string._native_ptr(), usage};
}

void ClassDB::add_class(const ClassDescription &p_class) {
	auto record = std::make_unique<ClassRecord>();
	record->name = p_class.name;
	record->parent = find_record(p_class.parent);
	GDExtensionClassCreationInfo4 info = p_class.info;
	info.get_virtual_func = find_override;
	info.class_userdata = record.get();
	records.push_back(std::move(record));
	gdextension_interface::classdb_register_extension_class4(
			library, p_class.name._native_ptr(), p_class.parent._native_ptr(), &info);
	p_class.bind();
}

void ClassDB::unregister_classes() {
	for (; !records.empty(); records.pop_back()) {
		gdextension_interface::classdb_unregister_extension_class(library, records.back()->name._native_ptr());
	}
}

void ClassDB::add_method(const StringName &p_class, const MethodDefinition &p_definition,
		const MethodDescription &p_method, const MethodPointer &p_pointer, std::initializer_list<Variant> p_defaults) {
	auto bind = std::make_unique<MethodBind>(MethodBind{p_pointer, p_defaults});
	std::vector<PropertyInfo> arguments;
	std::vector<GDExtensionClassMethodArgumentMetadata> metadata;
	for (const DescribedType &type : p_method.arguments) {
		arguments.push_back(type.info());
		metadata.push_back(type.metadata);
	}
	for (std::size_t i = 0; i < arguments.size() && i < p_definition.arguments.size(); ++i) {
		arguments[i].name = p_definition.arguments[i];
	}
	std::vector<GDExtensionPropertyInfo> native_arguments = native_infos(arguments);
	const PropertyInfo result = p_method.result.info();
	GDExtensionPropertyInfo native_result = result._native();
	std::vector<GDExtensionVariantPtr> defaults;
	for (Variant &value : bind->defaults) {
		defaults.push_back(&value);
	}
	GDExtensionClassMethodInfo info{};
	info.name = p_definition.name._native_ptr();
	info.method_userdata = bind.get();
	info.call_func = p_method.call;
	info.ptrcall_func = p_method.ptrcall;
	info.method_flags = p_method.flags;
	info.has_return_value = p_method.has_result;
	info.return_value_info = &native_result;
	info.return_value_metadata = p_method.result.metadata;
	info.argument_count = static_cast<uint32_t>(arguments.size());
	info.arguments_info = native_arguments.data();
	info.arguments_metadata = metadata.data();
	info.default_argument_count = static_cast<uint32_t>(defaults.size());
	info.default_arguments = defaults.data();
	gdextension_interface::classdb_register_extension_class_method(library, p_class._native_ptr(), &info);
	find_record(p_class)->methods.push_back(std::move(bind));
}

void ClassDB::bind_integer_constant(
		const StringName &p_class, const StringName &p_enum, const StringName &p_constant, GDExtensionInt p_value) {
	gdextension_interface::classdb_register_extension_class_integer_constant(
			library, p_class._native_ptr(), p_enum._native_ptr(), p_constant._native_ptr(), p_value, false);
}

void ClassDB::add_property(const StringName &p_class, const PropertyInfo &p_property, const StringName &p_setter,
		const StringName &p_getter) {
	const GDExtensionPropertyInfo info = p_property._native();
	gdextension_interface::classdb_register_extension_class_property(
			library, p_class._native_ptr(), &info, p_setter._native_ptr(), p_getter._native_ptr());
}

void ClassDB::add_property_group(const StringName &p_class, const String &p_name, const String &p_prefix) {
	gdextension_interface::classdb_register_extension_class_property_group(
			library, p_class._native_ptr(), p_name._native_ptr(), p_prefix._native_ptr());
}

void ClassDB::add_property_subgroup(const StringName &p_class, const String &p_name, const String &p_prefix) {
	gdextension_interface::classdb_register_extension_class_property_subgroup(
			library, p_class._native_ptr(), p_name._native_ptr(), p_prefix._native_ptr());
}

void ClassDB::add_signal(const StringName &p_class, const MethodInfo &p_signal) {
	const std::vector<GDExtensionPropertyInfo> arguments = native_infos(p_signal.arguments);
	gdextension_interface::classdb_register_extension_class_signal(library, p_class._native_ptr(),
			p_signal.name._native_ptr(), arguments.data(), static_cast<GDExtensionInt>(arguments.size()));
}

void ClassDB::add_virtual_method(
		const StringName &p_class, MethodInfo p_method, const std::vector<StringName> &p_arguments) {
	for (std::size_t i = 0; i < p_method.arguments.size() && i < p_arguments.size(); ++i) {
		p_method.arguments[i].name = p_arguments[i];
	}
	std::vector<GDExtensionPropertyInfo> arguments = native_infos(p_method.arguments);
	GDExtensionClassVirtualMethodInfo info{};
	info.name = p_method.name._native_ptr();
	info.method_flags = p_method.flags;
	info.return_value = p_method.return_val._native();
	info.return_value_metadata = p_method.return_val_metadata;
	info.argument_count = static_cast<uint32_t>(arguments.size());
	info.arguments = arguments.data();
	info.arguments_metadata = p_method.arguments_metadata.data();
	gdextension_interface::classdb_register_extension_class_virtual_method(library, p_class._native_ptr(), &info);
}

} // namespace godot
