#include "nodes/common/stripped.hpp"

#include <godot_cpp/core/object.hpp>

using namespace godot;

namespace thicket {

bool is_stripped(const Ref<Resource> &p_resource) {
	return p_resource.is_valid() &&
			(p_resource->is_class("PlaceholderMesh") || p_resource->is_class("PlaceholderTexture2D"));
}

String stripped_problem(const String &p_property, const String &p_consequence) {
	return p_property + String(" was stripped from this export: ") + p_consequence +
			String(". Export again with the Thicket plugin enabled, or set the file to Keep in the export's Resources "
				   "tab.");
}

} // namespace thicket
