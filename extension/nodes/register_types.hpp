#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// Registers our classes with the engine, at the scene level. Called once for every level.
void initialize(godot::ModuleInitializationLevel p_level);

/// Called once for every level when the library is unloaded, in reverse order.
void terminate(godot::ModuleInitializationLevel p_level);

} // namespace thicket
