#pragma once

#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/ref.hpp>

namespace thicket {

/// Registers the ground classes of release 0.2 under their old names, so that its files open. Scripts and the editor do not see them.
void register_former_grounds();

/// Returns the ground itself. For a ground of release 0.2, returns one of the current class with the same properties.
/// The new ground takes over the path of the file, so that saving it stores the current class. Any thread.
godot::Ref<ScatterGround> current_ground(const godot::Ref<ScatterGround> &p_ground);

} // namespace thicket
