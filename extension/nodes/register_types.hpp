#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// Registers our classes with the engine. The engine calls this once per initialization level; only
/// the call for the scene level has an effect.
void initialize(godot::ModuleInitializationLevel p_level);

/// Drops queued main-thread calls. The engine calls this once per level, in reverse order, when it
/// unloads the library.
void terminate(godot::ModuleInitializationLevel p_level);

} // namespace thicket
