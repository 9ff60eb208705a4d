#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// Returns true if the engine's real_t has the size that this library was compiled for. If the
/// sizes differ, so does the memory layout of vectors. The function then prints an error that
/// explains how to fix it, and the library must not be initialized. Calls the engine's C interface
/// directly, so it works before godot-cpp is initialized.
bool fits_precision(GDExtensionInterfaceGetProcAddress p_get_proc_address);

} // namespace thicket
