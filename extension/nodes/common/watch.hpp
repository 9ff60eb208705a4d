#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Connects a signal of `p_source` to a bound method of `p_watcher`, or disconnects it if `p_watch`
/// is false. Does nothing if the source is null or the connection is already in the requested
/// state. The connection refers to the method by name, so it survives a reload of the extension.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch);

/// Like the function above, but appends `p_argument` to the arguments of the signal. A method can
/// only be connected once per source, so each source must always use the same argument.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch, const godot::Variant &p_argument);

} // namespace thicket
