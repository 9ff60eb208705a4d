#include <godot_cpp/variant/variant.hpp>

#include <godot_cpp/core/builtin_call.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/lazy_name.hpp>

#include <mutex>
#include <string>
#include <utility>

namespace godot {

namespace internal {

BuiltinFunctions builtin_functions[GDEXTENSION_VARIANT_TYPE_VARIANT_MAX];

void load_builtin_functions() {
	for (int i = GDEXTENSION_VARIANT_TYPE_NIL + 1; i < GDEXTENSION_VARIANT_TYPE_VARIANT_MAX; ++i) {
		const auto type = static_cast<GDExtensionVariantType>(i);
		BuiltinFunctions &functions = builtin_functions[i];
		functions.to_variant = gdextension_interface::get_variant_from_type_constructor(type);
		functions.from_variant = gdextension_interface::get_variant_to_type_constructor(type);
		functions.destroy = gdextension_interface::variant_get_ptr_destructor(type);
		if (functions.destroy) {
			functions.construct = gdextension_interface::variant_get_ptr_constructor(type, 0);
			functions.copy = gdextension_interface::variant_get_ptr_constructor(type, 1);
			functions.equal =
					gdextension_interface::variant_get_ptr_operator_evaluator(GDEXTENSION_VARIANT_OP_EQUAL, type, type);
		}
	}
}

BuiltinMethod::BuiltinMethod(GDExtensionVariantType p_type, const char *p_name, GDExtensionInt p_hash) :
		method_(gdextension_interface::variant_get_ptr_builtin_method(
				p_type, StringName(p_name)._native_ptr(), p_hash)) {}

bool can_convert(const Variant &p_value, GDExtensionVariantType p_type) {
	const auto type = static_cast<GDExtensionVariantType>(p_value.get_type());
	return type == p_type || gdextension_interface::variant_can_convert_strict(type, p_type);
}

String type_name(GDExtensionVariantType p_type) {
	String name{Uninitialized{}};
	gdextension_interface::variant_get_type_name(p_type, name._native_ptr());
	return name;
}

namespace {

std::mutex names_mutex;
LazyName *created_names = nullptr;

} // namespace

void LazyName::create() {
	const std::lock_guard lock(names_mutex);
	if (!is_created_.load(std::memory_order_relaxed)) {
		name_.emplace(text_);
		next_ = std::exchange(created_names, this);
		is_created_.store(true, std::memory_order_release);
	}
}

void LazyName::release_all() {
	const std::lock_guard lock(names_mutex);
	while (LazyName *name = created_names) {
		created_names = std::exchange(name->next_, nullptr);
		name->is_created_.store(false, std::memory_order_relaxed);
		name->name_.reset();
	}
}

} // namespace internal

Variant::Variant() { gdextension_interface::variant_new_nil(storage_); }

Variant::Variant(const Variant &p_from) { gdextension_interface::variant_new_copy(storage_, p_from.storage_); }

Variant::Variant(Variant &&p_from) noexcept : Variant() { *this = std::move(p_from); }

Variant::Variant(const char *p_utf8) : Variant(String(p_utf8)) {}

Variant::Variant(const Object *p_object) {
	GodotObject *owner = internal::owner_of(p_object);
	internal::builtin_functions[OBJECT].to_variant(storage_, &owner);
}

Variant::Variant(const Array &p_array) {
	internal::builtin_functions[ARRAY].to_variant(storage_, p_array._native_ptr());
}

Variant::Variant(const Dictionary &p_dictionary) {
	internal::builtin_functions[DICTIONARY].to_variant(storage_, p_dictionary._native_ptr());
}

Variant::~Variant() { gdextension_interface::variant_destroy(storage_); }

Variant &Variant::operator=(const Variant &p_from) { return *this = Variant(p_from); }

Variant &Variant::operator=(Variant &&p_from) noexcept {
	std::swap_ranges(storage_, storage_ + sizeof(storage_), p_from.storage_);
	return *this;
}

Object *Variant::get_validated_object() const {
	const GDObjectInstanceID id = gdextension_interface::variant_get_object_instance_id(storage_);
	return id == 0 ? nullptr : internal::wrapper_of(gdextension_interface::object_get_instance_from_id(id));
}

Variant::Type Variant::get_type() const { return static_cast<Type>(gdextension_interface::variant_get_type(storage_)); }

void Variant::callp(const StringName &p_method, const Variant **p_args, int p_count, Variant &r_result,
		GDExtensionCallError &r_error) {
	gdextension_interface::variant_call(_native_ptr(), p_method._native_ptr(),
			reinterpret_cast<const GDExtensionConstVariantPtr *>(p_args), p_count, r_result._native_ptr(), &r_error);
}

String::String(const char *p_utf8) : Opaque(internal::Uninitialized{}) {
	gdextension_interface::string_new_with_utf8_chars(_native_ptr(), p_utf8);
}

CharString String::utf8() const {
	const GDExtensionInt size = gdextension_interface::string_to_utf8_chars(_native_ptr(), nullptr, 0);
	std::string text(static_cast<std::size_t>(size), '\0');
	gdextension_interface::string_to_utf8_chars(_native_ptr(), text.data(), size);
	return CharString(std::move(text));
}

String String::operator+(const StringName &p_right) const { return *this + String(p_right); }

StringName::StringName(const char *p_utf8) : Opaque(internal::Uninitialized{}) {
	gdextension_interface::string_name_new_with_utf8_chars(_native_ptr(), p_utf8);
}

bool StringName::operator<(const StringName &p_other) const {
	return *static_cast<void *const *>(_native_ptr()) < *static_cast<void *const *>(p_other._native_ptr());
}

const Variant &Array::operator[](int64_t p_index) const {
	return *static_cast<const Variant *>(gdextension_interface::array_operator_index_const(_native_ptr(), p_index));
}

Variant &Array::operator[](int64_t p_index) {
	return *static_cast<Variant *>(gdextension_interface::array_operator_index(_native_ptr(), p_index));
}

void Array::set_typed(uint32_t p_type, const StringName &p_class, const Variant &p_script) {
	gdextension_interface::array_set_typed(
			_native_ptr(), static_cast<GDExtensionVariantType>(p_type), p_class._native_ptr(), p_script._native_ptr());
}

const Variant &Dictionary::operator[](const Variant &p_key) const {
	return *static_cast<const Variant *>(
			gdextension_interface::dictionary_operator_index_const(_native_ptr(), p_key._native_ptr()));
}

Variant &Dictionary::operator[](const Variant &p_key) {
	return *static_cast<Variant *>(
			gdextension_interface::dictionary_operator_index(_native_ptr(), p_key._native_ptr()));
}

void Dictionary::set_typed(uint32_t p_key_type, const StringName &p_key_class, const Variant &p_key_script,
		uint32_t p_value_type, const StringName &p_value_class, const Variant &p_value_script) {
	gdextension_interface::dictionary_set_typed(_native_ptr(), static_cast<GDExtensionVariantType>(p_key_type),
			p_key_class._native_ptr(), p_key_script._native_ptr(), static_cast<GDExtensionVariantType>(p_value_type),
			p_value_class._native_ptr(), p_value_script._native_ptr());
}

void _err_print_error(const char *p_function, const char *p_file, int p_line, const String &p_message,
		bool p_editor_notify, bool p_is_warning) {
	const auto print = p_is_warning ? gdextension_interface::print_warning : gdextension_interface::print_error;
	print(p_message.utf8().get_data(), p_function, p_file, p_line, static_cast<GDExtensionBool>(p_editor_notify));
}

} // namespace godot
