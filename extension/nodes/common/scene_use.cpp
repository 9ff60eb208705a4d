#include "nodes/common/scene_use.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/string.hpp>

#include <utility>

using namespace godot;

namespace thicket {

void SceneUse::replace(List list) {
	for (const List::Use &use : list.uses_) {
		if (!use.guard->enter_scene()) {
			ERR_PRINT(vformat(
					"A node in the scene tree uses a %s while another thread has been running one of its methods for a "
					"second. Let the method return before you assign the object to the node.",
					use.object->get_class()));
		}
	}
	// Destroying `previous_uses` frees the objects that have no other owner.
	const List previous_uses = std::exchange(current_uses_, std::move(list));
	for (const List::Use &use : previous_uses.uses_) {
		use.guard->leave_scene();
	}
}

} // namespace thicket
