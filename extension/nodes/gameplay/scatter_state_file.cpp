// A ScatterState as a file of bytes, and as a resource that the engine has cached.

#include "nodes/common/convert.hpp"
#include "nodes/common/file_replace.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/state_refusal.hpp"

#include <godot_cpp/classes/resource_loader.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/char_string.hpp>

#include <string>
#include <utility>

using namespace godot;

namespace thicket {

Error ScatterState::save_to_file(const String &p_path) const {
	std::vector<std::uint8_t> bytes;
	Error error = told("save_to_file", state_.save(bytes));
	if (error != OK) {
		return error;
	}
	String problem;
	error = replace_file(p_path, packed_bytes(bytes), problem);
	if (error != OK) {
		ERR_PRINT("ScatterState.save_to_file: " + problem);
	}
	return error;
}

Error ScatterState::load_from_file(const String &p_path) {
	PackedByteArray bytes;
	String problem;
	const Error error = read_saved_file(p_path, bytes, problem);
	if (error != OK) {
		ERR_PRINT("ScatterState.load_from_file: " + problem);
		return error;
	}
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	const Status status = state_.load({bytes.ptr(), static_cast<std::size_t>(bytes.size())}, changes);
	if (!status.ok()) {
		ERR_PRINT(vformat("ScatterState.load_from_file: cannot load %s: %s", p_path, String(describe(status).c_str())));
	}
	tell(std::move(changes));
	return error_of(status);
}

void ScatterState::warn_if_cached() {
	const String path = get_path();
	const std::string text = path.utf8().get_data();
	const bool is_file = !text.empty() && text.find("::") == std::string::npos;
	if (warned_ || !is_file || ResourceLoader::get_singleton()->get_cached_ref(path) != Ref<Resource>(this)) {
		return;
	}
	warned_ = true;
	WARN_PRINT(vformat(
			"TerrainScatter3D.state: load() keeps %s in memory, and returns this same state again, with all that the "
			"game "
			"changes. For saved games call ScatterState.save_to_file() and load_from_file(). For what a designer has "
			"placed set ScatterState.designed, so that each node gets a copy.",
			path));
}

} // namespace thicket
