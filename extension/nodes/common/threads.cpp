#include "nodes/common/threads.hpp"

#include <godot_cpp/classes/os.hpp>
#include <godot_cpp/classes/project_settings.hpp>

#include <cstdint>

using namespace godot;

namespace thicket {

bool has_threads() {
	const Variant most = ProjectSettings::get_singleton()->get_setting("threading/worker_pool/max_threads", -1);
	return OS::get_singleton()->has_feature("threads") && static_cast<int64_t>(most) != 0;
}

} // namespace thicket
