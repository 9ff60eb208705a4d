#include "tests/loader/fake_engine.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

namespace thicket::loader {

namespace {

bool is_double = false;

// --- Types ---------------------------------------------------------------------------------------------------------------

/// Returns the text of a String, StringName or NodePath. The value stores a pointer to a
/// std::string, which is never freed, or null if the text is empty.
const std::string &text(GDExtensionConstTypePtr value) {
	static const std::string empty;
	const std::string *const stored = *static_cast<const std::string *const *>(value);
	return stored != nullptr ? *stored : empty;
}

void set_text(void *r_value, const std::string &content) {
	*static_cast<const std::string **>(r_value) = new std::string(content);
}

bool is_text(GDExtensionVariantType type) {
	return type == GDEXTENSION_VARIANT_TYPE_STRING || type == GDEXTENSION_VARIANT_TYPE_STRING_NAME ||
			type == GDEXTENSION_VARIANT_TYPE_NODE_PATH;
}

/// Returns the size of a value of this type, in bytes.
std::size_t size_of(GDExtensionVariantType type) {
	const std::size_t real = is_double ? 8 : 4;
	switch (type) {
		case GDEXTENSION_VARIANT_TYPE_NIL: return 0;
		case GDEXTENSION_VARIANT_TYPE_BOOL: return 1;
		case GDEXTENSION_VARIANT_TYPE_INT:
		case GDEXTENSION_VARIANT_TYPE_FLOAT:
		case GDEXTENSION_VARIANT_TYPE_RID:
		case GDEXTENSION_VARIANT_TYPE_VECTOR2I: return 8;
		case GDEXTENSION_VARIANT_TYPE_VECTOR2: return 2 * real;
		case GDEXTENSION_VARIANT_TYPE_VECTOR3: return 3 * real;
		case GDEXTENSION_VARIANT_TYPE_RECT2:
		case GDEXTENSION_VARIANT_TYPE_VECTOR4:
		case GDEXTENSION_VARIANT_TYPE_PLANE:
		case GDEXTENSION_VARIANT_TYPE_QUATERNION: return 4 * real;
		case GDEXTENSION_VARIANT_TYPE_VECTOR3I: return 12;
		case GDEXTENSION_VARIANT_TYPE_RECT2I:
		case GDEXTENSION_VARIANT_TYPE_VECTOR4I:
		case GDEXTENSION_VARIANT_TYPE_COLOR:
		case GDEXTENSION_VARIANT_TYPE_CALLABLE:
		case GDEXTENSION_VARIANT_TYPE_SIGNAL: return 16;
		case GDEXTENSION_VARIANT_TYPE_TRANSFORM2D:
		case GDEXTENSION_VARIANT_TYPE_AABB: return 6 * real;
		case GDEXTENSION_VARIANT_TYPE_BASIS: return 9 * real;
		case GDEXTENSION_VARIANT_TYPE_TRANSFORM3D: return 12 * real;
		case GDEXTENSION_VARIANT_TYPE_PROJECTION: return 16 * real;
		case GDEXTENSION_VARIANT_TYPE_STRING:
		case GDEXTENSION_VARIANT_TYPE_STRING_NAME:
		case GDEXTENSION_VARIANT_TYPE_NODE_PATH:
		case GDEXTENSION_VARIANT_TYPE_OBJECT:
		case GDEXTENSION_VARIANT_TYPE_DICTIONARY:
		case GDEXTENSION_VARIANT_TYPE_ARRAY: return sizeof(void *);
		default: return 2 * sizeof(void *); // Packed arrays.
	}
}

/// A Variant: its type and the first 16 bytes of its value.
struct Value {
	GDExtensionVariantType type;
	std::array<unsigned char, 16> bytes;
};
static_assert(sizeof(Value) <= 24);

Value &value(void *variant) { return *static_cast<Value *>(variant); }

/// Returns `Make<N>::function` for a type that is known only at run time. Like the engine, it
/// provides one function per type.
template <template <std::size_t> class Make, class Function, std::size_t... Types>
Function choose(GDExtensionVariantType type, std::index_sequence<Types...>) {
	static constexpr std::array<Function, sizeof...(Types)> all{Make<Types>::function...};
	return all[static_cast<std::size_t>(type)];
}

template <template <std::size_t> class Make, class Function>
Function for_type(GDExtensionVariantType type) {
	return choose<Make, Function>(type, std::make_index_sequence<GDEXTENSION_VARIANT_TYPE_VARIANT_MAX>());
}

template <std::size_t Type>
struct Constructor {
	static void function(GDExtensionUninitializedTypePtr r_value, const GDExtensionConstTypePtr *) {
		std::memset(r_value, 0, size_of(static_cast<GDExtensionVariantType>(Type)));
	}
};

/// Copies a value of the same type, or converts one text type to another.
template <std::size_t Type>
struct CopyConstructor {
	static void function(GDExtensionUninitializedTypePtr r_value, const GDExtensionConstTypePtr *arguments) {
		std::memcpy(r_value, arguments[0], size_of(static_cast<GDExtensionVariantType>(Type)));
	}
};

template <std::size_t Type>
struct ToVariant {
	static void function(GDExtensionUninitializedVariantPtr r_variant, GDExtensionTypePtr from) {
		value(r_variant) = {static_cast<GDExtensionVariantType>(Type), {}};
		std::memcpy(value(r_variant).bytes.data(), from, std::min<std::size_t>(16, size_of(value(r_variant).type)));
	}
};

template <std::size_t Type>
struct FromVariant {
	static void function(GDExtensionUninitializedTypePtr r_value, GDExtensionVariantPtr variant) {
		const std::size_t size = size_of(static_cast<GDExtensionVariantType>(Type));
		std::memset(r_value, 0, size);
		if (value(variant).type == static_cast<GDExtensionVariantType>(Type)) {
			std::memcpy(r_value, value(variant).bytes.data(), std::min<std::size_t>(16, size));
		}
	}
};

GDExtensionPtrConstructor get_constructor(GDExtensionVariantType type, int32_t index) {
	return index == 0 ? for_type<Constructor, GDExtensionPtrConstructor>(type)
					  : for_type<CopyConstructor, GDExtensionPtrConstructor>(type);
}

GDExtensionPtrDestructor get_destructor(GDExtensionVariantType) {
	return [](GDExtensionTypePtr) {
	};
}

GDExtensionVariantFromTypeConstructorFunc to_variant(GDExtensionVariantType type) {
	return for_type<ToVariant, GDExtensionVariantFromTypeConstructorFunc>(type);
}

GDExtensionTypeFromVariantConstructorFunc from_variant(GDExtensionVariantType type) {
	return for_type<FromVariant, GDExtensionTypeFromVariantConstructorFunc>(type);
}

GDExtensionPtrOperatorEvaluator get_operator(
		GDExtensionVariantOperator op, GDExtensionVariantType left, GDExtensionVariantType) {
	if (is_text(left) && op == GDEXTENSION_VARIANT_OP_EQUAL) {
		return [](GDExtensionConstTypePtr a, GDExtensionConstTypePtr b, GDExtensionTypePtr r_result) {
			*static_cast<GDExtensionBool *>(r_result) = text(a) == text(b);
		};
	}
	if (is_text(left) && op == GDEXTENSION_VARIANT_OP_LESS) {
		return [](GDExtensionConstTypePtr a, GDExtensionConstTypePtr b, GDExtensionTypePtr r_result) {
			*static_cast<GDExtensionBool *>(r_result) = text(a) < text(b);
		};
	}
	if (is_text(left)) { // A concatenation or a format. Its result is never read.
		return [](GDExtensionConstTypePtr a, GDExtensionConstTypePtr, GDExtensionTypePtr r_result) {
			set_text(r_result, text(a));
		};
	}
	return [](GDExtensionConstTypePtr, GDExtensionConstTypePtr, GDExtensionTypePtr r_result) {
		*static_cast<GDExtensionBool *>(r_result) = 0;
	};
}

void new_text(GDExtensionUninitializedStringPtr r_text, const char *content) { set_text(r_text, content); }

GDExtensionInt copy_text(GDExtensionConstStringPtr from, char *r_text, GDExtensionInt most) {
	const std::string &content = text(from);
	if (r_text != nullptr) {
		std::memcpy(r_text, content.data(), std::min(static_cast<std::size_t>(most), content.size()));
	}
	return static_cast<GDExtensionInt>(content.size());
}

// --- Objects -------------------------------------------------------------------------------------------------------------

struct Object {
	std::string engine_class;
	GDExtensionClassInstancePtr instance = nullptr;
	void *binding = nullptr;
	GDExtensionInstanceBindingCallbacks callbacks{};
	void *library = nullptr;
};

Object *construct(GDExtensionConstStringNamePtr name) {
	++record().objects;
	return new Object{.engine_class = text(name)};
}

void set_instance(GDExtensionObjectPtr object, GDExtensionConstStringNamePtr, GDExtensionClassInstancePtr instance) {
	static_cast<Object *>(object)->instance = instance;
}

void set_binding(GDExtensionObjectPtr object, void *library, void *binding,
		const GDExtensionInstanceBindingCallbacks *callbacks) {
	auto &target = *static_cast<Object *>(object);
	target.binding = binding;
	target.callbacks = *callbacks;
	target.library = library;
}

void *get_binding(GDExtensionObjectPtr object, void *library, const GDExtensionInstanceBindingCallbacks *callbacks) {
	auto &target = *static_cast<Object *>(object);
	if (target.binding == nullptr && callbacks != nullptr) {
		set_binding(object, library, callbacks->create_callback(library, object), callbacks);
	}
	return target.binding;
}

void free_binding(GDExtensionObjectPtr object, void *library) {
	auto &target = *static_cast<Object *>(object);
	if (target.binding != nullptr) {
		target.callbacks.free_callback(library, object, target.binding);
		target.binding = nullptr;
	}
}

/// A cast succeeds only to the class with which the object was created.
GDExtensionObjectPtr cast_to(GDExtensionConstObjectPtr object, void *tag) {
	auto *const target = static_cast<Object *>(const_cast<void *>(object));
	return target->engine_class == *static_cast<std::string *>(tag) ? target : nullptr;
}

Object &singleton(const std::string &name) {
	static std::map<std::string, Object> all;
	return all.try_emplace(name, Object{.engine_class = name}).first->second;
}

// --- Classes -------------------------------------------------------------------------------------------------------------

RegisteredClass &find_class(GDExtensionConstStringNamePtr name) {
	for (RegisteredClass &known : record().classes) {
		if (known.name == text(name)) {
			return known;
		}
	}
	record().errors.push_back("no class is registered as " + text(name));
	return record().classes.emplace_back();
}

void register_class(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr name,
		GDExtensionConstStringNamePtr parent, const GDExtensionClassCreationInfo4 *info) {
	record().classes.push_back({text(name), text(parent), *info, {}, true});
}

void register_method(
		GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner, const GDExtensionClassMethodInfo *info) {
	find_class(owner).members.push_back(
			"method " + text(info->name) + "(" + std::to_string(info->argument_count) + ")");
}

void register_virtual(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner,
		const GDExtensionClassVirtualMethodInfo *info) {
	find_class(owner).members.push_back("virtual " + text(info->name));
}

void register_constant(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner, GDExtensionConstStringNamePtr,
		GDExtensionConstStringNamePtr name, GDExtensionInt number, GDExtensionBool) {
	find_class(owner).members.push_back("constant " + text(name) + " = " + std::to_string(number));
}

void register_property(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner,
		const GDExtensionPropertyInfo *info, GDExtensionConstStringNamePtr, GDExtensionConstStringNamePtr) {
	find_class(owner).members.push_back("property " + text(info->name));
}

void register_group(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner, GDExtensionConstStringPtr name,
		GDExtensionConstStringPtr) {
	find_class(owner).members.push_back("group " + text(name));
}

void register_signal(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr owner,
		GDExtensionConstStringNamePtr name, const GDExtensionPropertyInfo *, GDExtensionInt count) {
	find_class(owner).members.push_back("signal " + text(name) + "(" + std::to_string(count) + ")");
}

void unregister_class(GDExtensionClassLibraryPtr, GDExtensionConstStringNamePtr name) {
	find_class(name).registered = false;
}

void print_error(const char *message, const char *, const char *, int32_t, GDExtensionBool) {
	record().errors.emplace_back(message);
}

/// Stands in for every method of the engine. The caller's result keeps its initial value.
void call_method(GDExtensionMethodBindPtr, GDExtensionObjectPtr, const GDExtensionConstTypePtr *, GDExtensionTypePtr) {}

/// Stands in for functions that the library never calls here. In WebAssembly, a call with arguments
/// would trap.
void do_nothing() {}

template <class Function>
GDExtensionInterfaceFunctionPtr to_interface_function(Function function) {
	return reinterpret_cast<GDExtensionInterfaceFunctionPtr>(function);
}

const std::map<std::string, GDExtensionInterfaceFunctionPtr> &functions() {
	static const std::map<std::string, GDExtensionInterfaceFunctionPtr> all = {
			{"print_error", to_interface_function(print_error)},
			{"string_new_with_utf8_chars", to_interface_function(new_text)},
			{"string_name_new_with_utf8_chars", to_interface_function(new_text)},
			{"string_to_utf8_chars", to_interface_function(copy_text)},
			{"variant_get_ptr_constructor", to_interface_function(get_constructor)},
			{"variant_get_ptr_destructor", to_interface_function(get_destructor)},
			{"variant_get_ptr_operator_evaluator", to_interface_function(get_operator)},
			{"variant_get_ptr_builtin_method",
					to_interface_function(+[](GDExtensionVariantType, GDExtensionConstStringNamePtr, GDExtensionInt) {
						return +[](GDExtensionTypePtr, const GDExtensionConstTypePtr *, GDExtensionTypePtr, int) {
						};
					})},
			{"get_variant_from_type_constructor", to_interface_function(to_variant)},
			{"get_variant_to_type_constructor", to_interface_function(from_variant)},
			{"variant_new_nil", to_interface_function(+[](GDExtensionUninitializedVariantPtr r_variant) {
				 value(r_variant) = {};
			 })},
			{"variant_new_copy",
					to_interface_function(
							+[](GDExtensionUninitializedVariantPtr r_variant, GDExtensionConstVariantPtr from) {
								value(r_variant) = *static_cast<const Value *>(from);
							})},
			{"variant_destroy", to_interface_function(+[](GDExtensionVariantPtr) {})},
			{"variant_get_type", to_interface_function(+[](GDExtensionConstVariantPtr variant) {
				 return static_cast<const Value *>(variant)->type;
			 })},
			{"variant_get_type_name",
					to_interface_function(+[](GDExtensionVariantType, GDExtensionUninitializedStringPtr r_name) {
						set_text(r_name, "Variant");
					})},
			{"array_set_typed",
					to_interface_function(+[](GDExtensionTypePtr, GDExtensionVariantType, GDExtensionConstStringNamePtr,
												   GDExtensionConstVariantPtr) {})},
			{"classdb_construct_object2", to_interface_function(construct)},
			{"classdb_get_method_bind",
					to_interface_function(
							+[](GDExtensionConstStringNamePtr, GDExtensionConstStringNamePtr, GDExtensionInt) {
								return reinterpret_cast<GDExtensionMethodBindPtr>(
										&is_double); // The pointer only has to be non-null.
							})},
			{"classdb_get_class_tag", to_interface_function(+[](GDExtensionConstStringNamePtr name) -> void * {
				 return new std::string(text(name));
			 })},
			{"object_method_bind_ptrcall", to_interface_function(call_method)},
			{"object_cast_to", to_interface_function(cast_to)},
			{"object_set_instance", to_interface_function(set_instance)},
			{"object_set_instance_binding", to_interface_function(set_binding)},
			{"object_get_instance_binding", to_interface_function(get_binding)},
			{"object_free_instance_binding", to_interface_function(free_binding)},
			{"object_get_instance_id", to_interface_function(+[](GDExtensionConstObjectPtr object) {
				 return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(object));
			 })},
			{"object_get_instance_from_id", to_interface_function(+[](std::uint64_t id) {
				 return reinterpret_cast<GDExtensionObjectPtr>(static_cast<std::uintptr_t>(id));
			 })},
			{"global_get_singleton", to_interface_function(+[](GDExtensionConstStringNamePtr name) -> void * {
				 return &singleton(text(name));
			 })},
			{"classdb_register_extension_class4", to_interface_function(register_class)},
			{"classdb_register_extension_class_method", to_interface_function(register_method)},
			{"classdb_register_extension_class_virtual_method", to_interface_function(register_virtual)},
			{"classdb_register_extension_class_integer_constant", to_interface_function(register_constant)},
			{"classdb_register_extension_class_property", to_interface_function(register_property)},
			{"classdb_register_extension_class_property_group", to_interface_function(register_group)},
			{"classdb_register_extension_class_property_subgroup", to_interface_function(register_group)},
			{"classdb_register_extension_class_signal", to_interface_function(register_signal)},
			{"classdb_unregister_extension_class", to_interface_function(unregister_class)},
	};
	return all;
}

} // namespace

Record &record() {
	static Record created;
	return created;
}

GDExtensionClassInstancePtr instance_of(void *object) { return static_cast<Object *>(object)->instance; }

void set_double_precision(bool on) { is_double = on; }

GDExtensionInterfaceFunctionPtr get_proc_address(const char *name) {
	const auto known = functions().find(name);
	record().functions[name] = known != functions().end();
	return known != functions().end() ? known->second : do_nothing;
}

} // namespace thicket::loader
