#include "nodes/common/watch.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/callable.hpp>

using namespace godot;

namespace thicket {

namespace {

void set_connected(Object *p_source, const StringName &p_signal, const Callable &p_callable, bool p_connect) {
	if (p_source == nullptr || p_source->is_connected(p_signal, p_callable) == p_connect) {
		return;
	}
	if (p_connect) {
		p_source->connect(p_signal, p_callable);
	} else {
		p_source->disconnect(p_signal, p_callable);
	}
}

} // namespace

void watch(Object *p_source, const StringName &p_signal, Object *p_watcher, const StringName &p_method, bool p_watch) {
	set_connected(p_source, p_signal, Callable(p_watcher, p_method), p_watch);
}

void watch(Object *p_source, const StringName &p_signal, Object *p_watcher, const StringName &p_method, bool p_watch,
		const Variant &p_argument) {
	Array arguments;
	append(arguments, p_argument);
	set_connected(p_source, p_signal, Callable(p_watcher, p_method).bindv(arguments), p_watch);
}

} // namespace thicket
