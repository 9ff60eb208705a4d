#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Connects a signal of `p_source` to a bound method of `p_watcher`, or takes the connection away; does nothing for a null
/// source, or where that is so already. By the method's name: the connection outlives the C++ object when the extension is
/// loaded anew.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch);

/// The same; the method is given `p_argument` behind those of the signal. A method hears one source with one argument only.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch, const godot::Variant &p_argument);

} // namespace thicket
