// How a ground of meshes follows the scene: what has changed is noticed, read in portions, built on a worker, and told.

#include "nodes/terrain/scatter_terrain_meshes.hpp"

#include "nodes/common/property_check.hpp"

#include <godot_cpp/classes/scene_tree.hpp>

#include <algorithm>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Corners to read in a frame, one mesh at least: so many take the engine a millisecond or two to hand out.
constexpr std::size_t corners_per_frame = 100'000;

} // namespace

bool ScatterTerrainMeshes::is_behind() const {
	return !stale_ && (watch_.restless() || !queue_.empty() || !readings_.empty() || builder_.busy());
}

void ScatterTerrainMeshes::follow() {
	figures_.checks = 0;
	if (stale_ || !is_in_scene()) {
		return;
	}
	if (first_node()->get_tree()->get_node_count_in_group(group_) != listed_) {
		list_members(true);
	}
	figures_.checks = watch_.look(look());
	if (builder_.finish()) {
		take_built();
		return; // Who was told of it may have done anything.
	}
	if (builder_.busy()) {
		return;
	}
	if (queue_.empty() && watch_.due()) {
		list_members(true); // One may have come as another has gone.
		const std::set<std::uint64_t> changed = watch_.take_changed();
		queue_.assign(changed.rbegin(), changed.rend());
	}
	read_some();
}

/// The queue's next instances. With the last of them, all that was read goes to a worker.
void ScatterTerrainMeshes::read_some() {
	std::size_t corners = 0;
	for (std::size_t looked = 0; !queue_.empty() && looked < GroundWatch::nodes_per_frame; ++looked) {
		if (corners >= corners_per_frame) {
			return;
		}
		const std::uint64_t id = queue_.back();
		queue_.pop_back();
		corners += read_changed(id);
	}
	if (queue_.empty() && (!readings_.empty() || !gone_.empty())) {
		builder_.start(std::exchange(readings_, {}));
	}
}

/// Reads an instance for the worlds in which it is not as it was. Returns how many corners that took.
std::size_t ScatterTerrainMeshes::read_changed(std::uint64_t id) {
	const Variant *watched = watch_.node(id);
	const Variant node = watched != nullptr ? *watched : Variant();
	Object *source = nullptr;
	GroundSight sight = look()(node, source);
	if (sight.source == 0) {
		gone_.push_back(id);
		return 0;
	}
	sight.version = watch_.version(sight.source);
	std::vector<MeshReading> added;
	for (const GroundHost &host : hosts()) {
		const auto world = worlds_.find(host.id);
		const bool begun = std::ranges::find(added, host.offset, &MeshReading::offset) != added.end();
		if (world == worlds_.end() || begun) {
			continue;
		}
		const auto part = world->second.parts.find(id);
		if (part == world->second.parts.end()) {
			added.push_back({id, sight, host.offset, {}, nullptr, {}, nullptr});
		} else if (!same_in_world(part->second->sight, part->second->offset, sight, host.offset)) {
			added.push_back({id, sight, host.offset, {}, part->second, {}, nullptr});
		}
	}
	if (added.empty()) {
		// Fast path: it is where it was in all worlds, and as it was.
		return 0;
	}
	PackedVector3Array faces;
	const std::uint64_t run = run_;
	if (!read_mesh(node, sight, faces) || run != run_) {
		return 0;
	}
	for (MeshReading &reading : added) {
		reading.sight = sight;
		reading.faces = faces;
		readings_.push_back(std::move(reading));
	}
	return static_cast<std::size_t>(faces.size());
}

/// What was built becomes the ground. A mesh that is refused stays as it was before, and is told.
void ScatterTerrainMeshes::take_built() {
	const bool was_empty = is_empty();
	const std::vector<MeshReading> built = builder_.take();
	const std::vector<std::uint64_t> gone = std::exchange(gone_, {});
	std::vector<Rect> areas;
	for (const MeshReading &reading : built) {
		report("ScatterTerrainMeshes", reading.status);
	}
	for (const GroundHost &host : hosts()) {
		const auto world = worlds_.find(host.id);
		if (world == worlds_.end()) {
			continue;
		}
		const GroundMeshes before = world->second.parts;
		GroundMeshes &parts = world->second.parts;
		for (const std::uint64_t id : gone) {
			parts.erase(id);
		}
		for (const MeshReading &reading : built) {
			if (reading.part != nullptr && reading.offset == host.offset) {
				parts[reading.id] = reading.part;
			}
		}
		if (add_changes(before, parts, areas)) {
			close(world->second);
		}
	}
	last_ = !hosts().empty() && worlds_.contains(hosts().front().id) ? worlds_[hosts().front().id].ground : last_;
	tell(areas, was_empty);
}

bool ScatterTerrainMeshes::distrust() {
	if (!stale_) {
		watch_.touch_all(true);
	}
	return true;
}

} // namespace thicket
