#pragma once

#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Sets a property by the name under which release 0.2 saved it, and warns once for each name. Returns false for any other name, so that
/// `_set` can return it. Any thread.
bool set_renamed(godot::Object *p_object, const godot::StringName &p_name, const godot::Variant &p_value);

/// Warns once that files use a property name of release 0.2, and explains how to save them with the current one. Any thread.
void warn_of_rename(const char *p_former, const char *p_current);

/// Warns once about a name of release 0.2 that has no direct replacement. `p_change` is the end of the sentence, up to
/// "since version 0.3".
void warn_of_change(const char *p_former, const char *p_change);

/// Warns once that a property of release 0.2 has no effect any more. `p_remedy` is a sentence without its period.
void warn_of_removal(const char *p_former, const char *p_remedy);

} // namespace thicket
