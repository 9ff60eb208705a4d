#pragma once

#include <godot_cpp/classes/engine.hpp>

namespace thicket {

/// Whether this is the editor, not a game.
inline bool in_editor() { return godot::Engine::get_singleton()->is_editor_hint(); }

} // namespace thicket
