#include "nodes/common/watch.hpp"

#include <godot_cpp/variant/callable.hpp>

using namespace godot;

namespace thicket {

void watch(Object *p_source, const StringName &p_signal, Object *p_watcher, const StringName &p_method, bool p_watch) {
	const Callable on_signal(p_watcher, p_method);
	if (p_source == nullptr || p_source->is_connected(p_signal, on_signal) == p_watch) {
		return;
	}
	if (p_watch) {
		p_source->connect(p_signal, on_signal);
	} else {
		p_source->disconnect(p_signal, on_signal);
	}
}

} // namespace thicket
