#pragma once

#include <godot_cpp/core/class_db.hpp>

namespace thicket {

/// Adds a property that is read-only for scripts, not saved, and not shown in the inspector.
inline void bind_value(const char *p_class, const godot::PropertyInfo &p_info, const char *p_getter) {
	godot::PropertyInfo info = p_info;
	info.usage = godot::PROPERTY_USAGE_NONE;
	godot::ClassDB::add_property(p_class, info, "", p_getter);
}

} // namespace thicket
