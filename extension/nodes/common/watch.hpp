#pragma once

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/variant.hpp>

namespace thicket {

/// Connects a signal of `p_source` to a bound method of `p_watcher`, or disconnects it. Does nothing if the source is
/// null or already connected as requested. The connection refers to the method by name, so it outlives the C++ object
/// when the extension is reloaded.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch);

/// Connects or disconnects a method that gets `p_argument` after the arguments of the signal. Each method can watch one source with one
/// argument only.
void watch(godot::Object *p_source, const godot::StringName &p_signal, godot::Object *p_watcher,
		const godot::StringName &p_method, bool p_watch, const godot::Variant &p_argument);

} // namespace thicket
