#pragma once

#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/ref.hpp>

namespace thicket {

/// Registers the ground classes of release 0.2 under their old names, so that old files can be
/// opened and old scripts that extend the classes still run. The classes are virtual, so the editor
/// does not offer to create them. (Since Godot 4.5, files cannot contain objects of a class that
/// godot-cpp registers as internal.)
void register_former_grounds();

/// Converts a ground of release 0.2 without a script to the current class, with the same
/// properties. Returns any other ground unchanged. The new ground takes over the resource path, so
/// that saving the file stores the current class. Any thread may call this function.
godot::Ref<ScatterGround> current_ground(const godot::Ref<ScatterGround> &p_ground);

} // namespace thicket
