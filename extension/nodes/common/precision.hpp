#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// True if the engine's real numbers have as many bits as those that this library was compiled for. If they differ,
/// vectors have a different memory layout. The function then prints what to do, and the library must not be opened. It
/// queries the engine directly and works before anything else is initialized.
bool fits_precision(GDExtensionInterfaceGetProcAddress p_get_proc_address);

} // namespace thicket
