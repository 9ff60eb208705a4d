#pragma once

#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Sets a property by its name in release 0.2, and warns once per name. Returns false for other
/// names. `_set` can return this value directly. Any thread may call it.
bool set_renamed(godot::Object *p_object, const godot::StringName &p_name, const godot::Variant &p_value);

/// Warns, once per name, that a file uses a property or class name of release 0.2, and explains how
/// to update it. Any thread may call it.
void warn_of_rename(const char *p_old_name, const char *p_new_name);

/// Warns, once per name, that a script extends a class by its name of release 0.2. Any thread may
/// call it.
void warn_of_base(const char *p_old_name, const char *p_new_name);

/// Warns like warn_of_rename, but for a name without a direct replacement. `p_change` is the part
/// of the message between the name and "since version 0.3".
void warn_of_change(const char *p_old_name, const char *p_change);

/// Warns, once per name, that a property of release 0.2 no longer has an effect. `p_remedy` is the
/// end of the warning: a sentence without its period that explains how to fix the file.
void warn_of_removal(const char *p_old_name, const char *p_remedy);

} // namespace thicket
