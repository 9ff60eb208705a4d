#pragma once

#include <godot_cpp/godot.hpp>

namespace thicket {

/// Makes our classes known to the engine, at the level at which it knows its scenes; called once for every level.
void initialize(godot::ModuleInitializationLevel p_level);

/// Called once for every level when the library is closed, in the other order.
void terminate(godot::ModuleInitializationLevel p_level);

} // namespace thicket
