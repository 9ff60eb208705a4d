#include <godot_cpp/godot.hpp>

#include <godot_cpp/core/class_db.hpp>

#include <string>

namespace godot {

namespace internal {

GDExtensionClassLibraryPtr library = nullptr;

namespace {

struct {
	int uncompressed_size = 0;
	int compressed_size = 0;
	const unsigned char *data = nullptr;
} doc_data;

GDExtensionBinding::Callback initializer = nullptr;
GDExtensionBinding::Callback terminator = nullptr;

void load_docs() {
	constexpr int64_t compression_deflate = 1; // FileAccess.COMPRESSION_DEFLATE
	PackedByteArray compressed;
	compressed.resize(doc_data.compressed_size);
	if (compressed.size() != doc_data.compressed_size) {
		return; // The engine is out of memory and has printed an error.
	}
	std::copy_n(doc_data.data, doc_data.compressed_size, compressed.ptrw());
	const PackedByteArray xml = compressed.decompress(doc_data.uncompressed_size, compression_deflate);
	gdextension_interface::editor_help_load_xml_from_utf8_chars_and_len(
			reinterpret_cast<const char *>(xml.ptr()), xml.size());
}

void initialize(void *, GDExtensionInitializationLevel p_level) {
	if (initializer) {
		initializer(static_cast<ModuleInitializationLevel>(p_level));
	}
	if (p_level == GDEXTENSION_INITIALIZATION_EDITOR && doc_data.data) {
		load_docs();
	}
}

void deinitialize(void *, GDExtensionInitializationLevel p_level) {
	if (terminator) {
		terminator(static_cast<ModuleInitializationLevel>(p_level));
	}
	if (p_level == GDEXTENSION_INITIALIZATION_SCENE) {
		ClassDB::unregister_classes();
	}
	if (p_level == GDEXTENSION_INITIALIZATION_CORE) {
		release_wrappers();
		LazyName::release_all();
	}
}

} // namespace

DocDataRegistration::DocDataRegistration(
		const char *, int p_uncompressed_size, int p_compressed_size, const unsigned char *p_data) {
	doc_data = {p_uncompressed_size, p_compressed_size, p_data};
}

} // namespace internal

GDExtensionBinding::InitObject::InitObject(GDExtensionInterfaceGetProcAddress p_get_proc_address,
		GDExtensionClassLibraryPtr p_library, GDExtensionInitialization *r_initialization) :
		get_proc_address_(p_get_proc_address), initialization_(r_initialization) {
	internal::library = p_library;
	initialization_->initialize = internal::initialize;
	initialization_->deinitialize = internal::deinitialize;
}

void GDExtensionBinding::InitObject::register_initializer(Callback p_callback) const {
	internal::initializer = p_callback;
}

void GDExtensionBinding::InitObject::register_terminator(Callback p_callback) const {
	internal::terminator = p_callback;
}

void GDExtensionBinding::InitObject::set_minimum_library_initialization_level(ModuleInitializationLevel p_level) const {
	initialization_->minimum_initialization_level = static_cast<GDExtensionInitializationLevel>(p_level);
}

GDExtensionBool GDExtensionBinding::InitObject::init() const {
	if (const char *missing_function = internal::load_interface(get_proc_address_)) {
		auto print = reinterpret_cast<GDExtensionInterfacePrintError>(
				reinterpret_cast<void *>(get_proc_address_("print_error")));
		print((std::string("This engine lacks the interface function ") + missing_function).c_str(), __FUNCTION__,
				__FILE__, __LINE__, true);
		return false;
	}
	internal::load_builtin_functions();
	internal::register_engine_classes();
	return true;
}

} // namespace godot
