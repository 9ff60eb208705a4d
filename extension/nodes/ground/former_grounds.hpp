#pragma once

#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/ref.hpp>

namespace thicket {

/// Registers the ground classes of release 0.2 under their old names, so that old files can be
/// opened. The classes are internal: hidden from scripts and the editor.
void register_former_grounds();

/// Converts a ground of release 0.2 to the current class, with the same properties; returns any
/// other ground unchanged. The new ground takes over the resource path, so that saving the file
/// stores the current class. Any thread may call this function.
godot::Ref<ScatterGround> current_ground(const godot::Ref<ScatterGround> &p_ground);

} // namespace thicket
