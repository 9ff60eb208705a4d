#pragma once

#include <godot_cpp/core/gdextension_interface_loader.hpp>

namespace godot {

namespace internal {

/// The engine's handle of this library, which is also the token of all instance bindings.
extern GDExtensionClassLibraryPtr library;

/// The class reference in the engine's XML format, compressed by zlib. The editor gets it at startup
/// (`editor_help_load_xml_from_utf8_chars_and_len`). There is at most one, and its data must stay valid.
class DocDataRegistration {
public:
	DocDataRegistration(
			const char *p_hash, int p_uncompressed_size, int p_compressed_size, const unsigned char *p_data);
};

} // namespace internal

enum ModuleInitializationLevel {
	MODULE_INITIALIZATION_LEVEL_CORE = GDEXTENSION_INITIALIZATION_CORE,
	MODULE_INITIALIZATION_LEVEL_SERVERS = GDEXTENSION_INITIALIZATION_SERVERS,
	MODULE_INITIALIZATION_LEVEL_SCENE = GDEXTENSION_INITIALIZATION_SCENE,
	MODULE_INITIALIZATION_LEVEL_EDITOR = GDEXTENSION_INITIALIZATION_EDITOR,
};

/// The entry point: the entry function creates an InitObject, registers callbacks in it, and returns its init().
class GDExtensionBinding {
public:
	using Callback = void (*)(ModuleInitializationLevel p_level);

	class InitObject {
	public:
		InitObject(GDExtensionInterfaceGetProcAddress p_get_proc_address, GDExtensionClassLibraryPtr p_library,
				GDExtensionInitialization *r_initialization);

		/// Called for every level during startup and shutdown.
		void register_initializer(Callback p_callback) const;
		void register_terminator(Callback p_callback) const;
		void set_minimum_library_initialization_level(ModuleInitializationLevel p_level) const;

		/// Returns false and prints an error if this engine lacks a required interface function.
		GDExtensionBool init() const;

	private:
		GDExtensionInterfaceGetProcAddress get_proc_address_;
		GDExtensionInitialization *initialization_;
	};
};

} // namespace godot
