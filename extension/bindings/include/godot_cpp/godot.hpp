#pragma once

#include <godot_cpp/core/gdextension_interface_loader.hpp>

namespace godot {

namespace internal {

/// The engine's handle of this library. It is also the token of all instance bindings.
extern GDExtensionClassLibraryPtr library;

/// Registers the class reference, in the engine's XML format and compressed with zlib. The editor
/// loads it at startup (`editor_help_load_xml_from_utf8_chars_and_len`). Only one may exist, and
/// its data must stay valid.
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

/// Initializes the library. The library's entry function creates an InitObject, registers callbacks
/// with it, and returns the result of init().
class GDExtensionBinding {
public:
	using Callback = void (*)(ModuleInitializationLevel p_level);

	class InitObject {
	public:
		InitObject(GDExtensionInterfaceGetProcAddress p_get_proc_address, GDExtensionClassLibraryPtr p_library,
				GDExtensionInitialization *r_initialization);

		/// Sets the callback that is called once for each level during startup, and the callback
		/// for each level during shutdown.
		void register_initializer(Callback p_callback) const;
		void register_terminator(Callback p_callback) const;
		void set_minimum_library_initialization_level(ModuleInitializationLevel p_level) const;

		/// Completes the initialization. If the engine lacks a required interface function, prints
		/// an error and returns false.
		GDExtensionBool init() const;

	private:
		GDExtensionInterfaceGetProcAddress get_proc_address_;
		GDExtensionInitialization *initialization_;
	};
};

} // namespace godot
