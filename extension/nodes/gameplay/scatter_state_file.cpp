// This file contains the methods of ScatterState that save and load files and warn about states in
// the engine's resource cache.

#include "nodes/common/convert.hpp"
#include "nodes/common/file_replace.hpp"
#include "nodes/common/resource_file.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/state_refusal.hpp"

#include <godot_cpp/classes/resource_loader.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <utility>

using namespace godot;

namespace thicket {

Error ScatterState::save_to_file(const String &p_path) const {
	std::vector<std::uint8_t> bytes;
	const Error error = report_outcome("save_to_file", state_.save(bytes));
	return error == OK ? replace_file("ScatterState.save_to_file", p_path, packed_bytes(bytes)) : error;
}

Error ScatterState::load_from_file(const String &p_path) {
	std::vector<InstanceChange> changes;
	const Error error =
			load_saved_file("ScatterState.load_from_file", p_path, [&](std::span<const std::uint8_t> bytes) {
				wait_for_diffs();
				return state_.load(bytes, changes);
			});
	notify(std::move(changes));
	return error;
}

void ScatterState::warn_if_cached() {
	const String path = get_path();
	if (has_warned_ || !is_own_file(path) ||
			ResourceLoader::get_singleton()->get_cached_ref(path) != Ref<Resource>(this)) {
		return;
	}
	has_warned_ = true;
	WARN_PRINT(vformat(
			"TerrainScatter3D.state: load() caches %s and returns this same state again, including all changes by the "
			"game. For saved games, call ScatterState.save_to_file() and load_from_file(). For instances placed by a "
			"designer, set ScatterState.copy_at_runtime, so that each node gets a copy.",
			path));
}

} // namespace thicket
