#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// True where the engine's real numbers have as many bits as those that this library was compiled for. Where they have not,
/// every vector would lie otherwise in memory, so it says what to do and the library must not be opened. It asks the engine
/// itself and works before anything else does.
bool fits_precision(GDExtensionInterfaceGetProcAddress p_get_proc_address);

} // namespace thicket
