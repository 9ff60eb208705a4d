#pragma once

#include <godot_cpp/classes/engine.hpp>

namespace thicket {

/// Returns true in the editor and false in a running game.
inline bool in_editor() { return godot::Engine::get_singleton()->is_editor_hint(); }

} // namespace thicket
