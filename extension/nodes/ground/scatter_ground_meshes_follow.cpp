// This file contains the part of ScatterGroundMeshes that tracks the scene. It detects changes,
// copies the meshes in steps, lets a worker build the ground, and emits signals for changed areas.

#include "nodes/ground/scatter_ground_meshes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/relative_transform.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Clock = std::chrono::steady_clock;

String name_of(const Variant &p_node) {
	const auto *node = Object::cast_to<Node>(p_node.get_validated_object());
	return node != nullptr ? String(node->get_name()) : String("?");
}

/// Explains why a mesh was rejected, with the name of its node and how to fix it.
String refusal_of(const String &p_name, const MeshReading &reading) {
	const bool is_misplaced = std::string_view(reading.status.property) == "corners" &&
			(reading.status.code == ErrorCode::not_finite || reading.status.code == ErrorCode::out_of_range);
	const String consequence = " Until then its ground is unchanged.";
	if (is_misplaced) {
		const glm::dvec3 &corner = reading.refused_corner;
		return vformat("%s: the mesh of \"%s\" has a corner at (%s, %s, %s): each coordinate must be finite and at "
					   "most %d m "
					   "from the world's origin. Fix the mesh or the node's transform.",
					   ScatterGroundMeshes::class_name, p_name, corner.x, corner.y, corner.z,
					   static_cast<std::int64_t>(TriangleTerrain::max_extent)) +
				consequence;
	}
	return vformat("%s: the mesh of \"%s\" cannot be ground: ", ScatterGroundMeshes::class_name, p_name) +
			String(describe(reading.status).c_str()) +
			vformat(". It may have at most %d triangles and only indices of its own vertices. Fix or divide the mesh.",
					static_cast<std::int64_t>(TriangleTerrain::max_triangles)) +
			consequence;
}

/// Finds the result of the work that began with the state of `world`; null if there is none.
const GroundWorld *find_world(const std::vector<GroundWorld> &worlds, const GroundWorld &world) {
	const auto match = std::ranges::find_if(worlds,
			[&](const GroundWorld &other) { return other.space == world.space && other.before == world.meshes; });
	return match != worlds.end() ? &*match : nullptr;
}

GroundSpace space_of(const GroundHost &host) { return {host.offset, host.local ? host.id : 0}; }

} // namespace

bool ScatterGroundMeshes::is_pending(std::uint64_t host) const {
	if (!is_in_scene()) {
		return false;
	}
	const auto world = worlds_.find(host);
	return is_stale_ || is_reading_all_ || world == worlds_.end() || world->second.ground == nullptr;
}

bool ScatterGroundMeshes::has_unapplied_changes() const {
	const bool any_pending =
			std::ranges::any_of(hosts(), [this](const GroundHost &host) { return is_pending(host.id); });
	return any_pending ||
			(is_in_scene() && (watch_.has_changes() || !queue_.empty() || !readings_.empty() || is_building_));
}

void ScatterGroundMeshes::follow() {
	figures_.checks = 0;
	if (!is_in_scene()) {
		return;
	}
	if (builder_.finish(false)) {
		take_result();
		return; // Signal handlers may have changed anything.
	}
	if (!is_stale_) {
		if (members_.count(first_node(), group_) != listed_count_) {
			list_members(true);
		}
		figures_.checks = watch_.check_next(state_reader());
	}
	if (builder_.busy()) {
		return;
	}
	if (is_stale_) {
		start_reading();
	} else if (queue_.empty() && watch_.has_changes()) {
		if (const std::set<std::uint64_t> changed_ids = watch_.take_changed(); !changed_ids.empty()) {
			queue_.assign(changed_ids.rbegin(), changed_ids.rend());
			// List again, because one node may have been added while another was removed.
			list_members(true);
		}
	}
	add_worlds();
	read_next(deadline());
}

void ScatterGroundMeshes::finish_reading() {
	const auto any_pending = [this] {
		return std::ranges::any_of(hosts(), [this](const GroundHost &host) { return is_pending(host.id); });
	};
	// Run at most two rounds, because the meshes that are being built may belong to a previous
	// group. Groups that signal handlers set during this loop are read in the next frame.
	for (int round = 0; round < 2 && any_pending(); ++round) {
		if (builder_.finish(true)) {
			take_result();
		} else {
			if (is_stale_) {
				start_reading();
			}
			add_worlds();
			build(true);
		}
	}
}

/// Lists the group and queues all its members for reading.
void ScatterGroundMeshes::start_reading() {
	builder_.finish(true);
	is_stale_ = false;
	is_reading_all_ = true;
	list_members(false);
	watch_.forget_changes();
	add_worlds();
	queue_all();
}

/// Queues all current and former instances of the group.
void ScatterGroundMeshes::queue_all() {
	const std::vector<std::uint64_t> watched_ids = watch_.ids();
	std::set<std::uint64_t> ids(watched_ids.begin(), watched_ids.end());
	for (const auto &[host, world] : worlds_) {
		for (const auto &[id, mesh] : *world.meshes) {
			ids.insert(id);
		}
	}
	reader_.cancel();
	queue_.assign(ids.rbegin(), ids.rend());
}

/// Adds a world for each new host. Hosts with the same space start with the same ground.
void ScatterGroundMeshes::add_worlds() {
	for (const GroundHost &host : hosts()) {
		const GroundSpace space = space_of(host);
		const auto entry = worlds_.find(host.id);
		if (entry != worlds_.end() && entry->second.ground != nullptr) {
			entry->second.space = space;
			continue;
		}
		const auto other_host = std::ranges::find_if(hosts(), [&](const GroundHost &other) {
			const auto world = worlds_.find(other.id);
			return space_of(other) == space && world != worlds_.end() && world->second.ground != nullptr;
		});
		if (other_host != hosts().end()) {
			// In the same space, the ground is the same.
			worlds_[host.id] = worlds_.at(other_host->id);
		} else if (entry == worlds_.end()) {
			worlds_[host.id] = {space, std::make_shared<GroundMeshes>(), nullptr, nullptr, {}, {}};
			queue_all();
		} else {
			entry->second.space = space;
		}
	}
}

/// Processes the next instances of the queue until the deadline. After the last one, starts a
/// worker that builds everything that was read.
void ScatterGroundMeshes::read_next(Clock::time_point deadline) {
	bool has_read = false;
	for (std::size_t planned_count = 0; !queue_.empty() && planned_count < GroundWatch::nodes_per_frame;) {
		if (has_read && Clock::now() >= deadline) {
			return;
		}
		if (reader_.busy()) {
			has_read = true;
			read_step();
		} else {
			plan_next();
			++planned_count;
		}
	}
	const bool has_work = is_reading_all_ || !readings_.empty() || !removed_ids_.empty() ||
			!unneeded_objects_.empty() || lacks_ground();
	if (queue_.empty() && has_work) {
		build(false);
	}
}

bool ScatterGroundMeshes::lacks_ground() const {
	return std::ranges::any_of(worlds_, [](const auto &world) { return world.second.ground == nullptr; });
}

/// Starts a worker that builds everything that was read. If `synchronously` is true, first reads
/// all queued instances, then builds synchronously.
void ScatterGroundMeshes::build(bool synchronously) {
	while (synchronously && !queue_.empty()) {
		if (reader_.busy()) {
			read_step();
		} else {
			plan_next();
		}
	}
	if (builder_.busy()) {
		return; // A script of a mesh has started other work.
	}
	MeshWork work{
			std::exchange(readings_, {}), std::exchange(removed_ids_, {}), {}, std::exchange(unneeded_objects_, {})};
	is_building_ = is_reading_all_ || !work.readings.empty() || !work.removed_ids.empty() || lacks_ground();
	for (const auto &[host, world] : worlds_) {
		if (is_building_ && find_world(work.worlds, world) == nullptr) {
			work.worlds.push_back(world);
			work.worlds.back().before = world.meshes;
		}
	}
	builder_.start(std::move(work), synchronously);
	if (synchronously && builder_.finish(true)) {
		take_result();
	}
}

/// Removes the last instance from the queue and records its work. If its mesh must be read first,
/// puts the instance back.
void ScatterGroundMeshes::plan_next() {
	const std::uint64_t id = queue_.back();
	queue_.pop_back(); // Remove the instance first, because `plan` may run scripts.
	if (!plan(id)) {
		queue_.push_back(id);
	}
}

/// Records the work for an instance in every world (see GroundWorld) in which it has changed.
/// Returns false if its mesh must be read first.
bool ScatterGroundMeshes::plan(std::uint64_t id) {
	const Variant *watched_node = watch_.node(id);
	const Variant node = watched_node != nullptr ? *watched_node : Variant();
	Object *source = nullptr;
	GroundNodeState state = state_reader()(node, source);
	if (state.source == 0) {
		removed_ids_.push_back(id);
		refusals_.erase(id);
		return true;
	}
	if (!is_finite(state.frame)) {
		reject(id,
				vformat("%s: the global_transform of \"%s\" must be finite. Until then its ground is unchanged.",
						class_name, name_of(node)));
		return true;
	}
	const FreshCopy fresh_copy = std::exchange(fresh_copy_, {});
	const bool is_just_read = fresh_copy.copy != nullptr && fresh_copy.id == id;
	// Use the version at which the mesh was read. Otherwise a mesh that changes while it is read
	// would be reread forever.
	state.version = is_just_read ? fresh_copy.version : watch_.version(state.source);
	std::vector<MeshReading> readings = readings_of(id, state);
	if (readings.empty()) {
		// The instance is unchanged in all worlds.
		refusals_.erase(id);
		return true;
	}
	const auto cached_copy = copies_.find(state.source);
	std::shared_ptr<const MeshCopy> copy = is_just_read ? fresh_copy.copy : nullptr;
	if (!is_just_read && cached_copy != copies_.end() && cached_copy->second.first == state.version) {
		copy = cached_copy->second.second.lock();
	}
	if (copy == nullptr) {
		std::vector<GroundPiece> pieces = GroundMembers::pieces(node);
		if (pieces.empty() && Object::cast_to<Shape3D>(source) != nullptr) {
			reject(id,
					vformat("%s: the collision shape of \"%s\" has no triangles, so it cannot be ground. Use another "
							"shape, or remove its body from the group.",
							class_name, name_of(node)));
			return true;
		}
		reader_.start(std::move(pieces), state.source, state.version);
		return false;
	}
	for (MeshReading &reading : readings) {
		reading.copy = copy;
		readings_.push_back(std::move(reading));
	}
	return true;
}

/// Returns the state of a node with its transform in a host's space. The transform of `state` may
/// be in another host's space.
GroundNodeState ScatterGroundMeshes::state_in_space(
		const GroundSpace &space, std::uint64_t id, const GroundNodeState &state) const {
	GroundNodeState result = state;
	const auto host = std::ranges::find(hosts(), space.host, &GroundHost::id);
	const Variant *watched_node = watch_.node(id);
	const auto *node =
			watched_node != nullptr ? Object::cast_to<Node3D>(watched_node->get_validated_object()) : nullptr;
	if (node == nullptr) {
		return result;
	}
	result.frame = host != hosts().end() && host->node->is_inside_tree() ? relative_transform(*host->node, *node)
																		 : node->get_global_transform();
	return result;
}

/// Returns one reading, without its mesh, for each space in which the node has changed.
std::vector<MeshReading> ScatterGroundMeshes::readings_of(std::uint64_t id, const GroundNodeState &state) const {
	std::vector<MeshReading> readings;
	for (const auto &[host, world] : worlds_) {
		const auto mesh = world.meshes->find(id);
		const std::shared_ptr<const GroundMesh> before = mesh != world.meshes->end() ? mesh->second : nullptr;
		const bool is_planned = std::ranges::find(readings, world.space, &MeshReading::space) != readings.end();
		const GroundNodeState state_in_world = state_in_space(world.space, id, state);
		const bool is_unchanged = before != nullptr && before->planet == planet_ &&
				before->space.host == world.space.host &&
				same_in_world(before->state, before->space.offset, state_in_world, world.space.offset);
		if (!is_planned && !is_unchanged) {
			readings.push_back(
					{id, state_in_world, world.space, nullptr, before, planet_, {}, glm::dvec3(0.0), nullptr});
		}
	}
	return readings;
}

/// Reads one surface for the queue's last instance.
void ScatterGroundMeshes::read_step() {
	const std::uint64_t source = reader_.source();
	const std::uint64_t version = reader_.version();
	if (const std::shared_ptr<const MeshCopy> copy = reader_.step(); copy != nullptr) {
		++figures_.reads;
		copies_[source] = {version, copy};
		fresh_copy_ = {queue_.empty() ? 0 : queue_.back(), version, copy};
	}
}

/// Applies the worker's result to the ground and emits signals.
void ScatterGroundMeshes::take_result() {
	const bool was_empty = is_empty();
	const MeshWork work = builder_.take();
	if (std::exchange(is_building_, false)) {
		is_reading_all_ = false;
	}
	std::vector<Rect> areas;
	for (auto &[id, world] : worlds_) {
		const GroundWorld *result = find_world(work.worlds, world);
		if (result == nullptr) {
			continue;
		}
		report(class_name, result->status);
		if (world.ground != nullptr) {
			for (const Rect &area : result->changes) {
				add_changed_area(areas, area);
			}
		}
		unneeded_objects_.push_back(world.meshes);
		unneeded_objects_.push_back(world.ground);
		world = *result;
		world.before = nullptr;
		if (world.ground == nullptr) {
			// After an error, which has been printed, use empty ground, because there is nothing to
			// wait for.
			world.ground = std::make_shared<TriangleParts>();
		}
	}
	std::erase_if(copies_, [](const auto &copy) { return copy.second.second.expired(); });
	last_ground_ = !hosts().empty() && worlds_.contains(hosts().front().id) ? worlds_[hosts().front().id].ground
																			: last_ground_;
	take_refusals(work);
	notify(areas, was_empty);
}

/// Updates the list of rejected meshes.
void ScatterGroundMeshes::take_refusals(const MeshWork &work) {
	for (const MeshReading &reading : work.readings) {
		const Variant *node = watch_.node(reading.id);
		if (reading.status.ok()) {
			refusals_.erase(reading.id);
		} else if (node != nullptr) {
			reject(reading.id, refusal_of(name_of(*node), reading));
		}
	}
}

void ScatterGroundMeshes::reject(std::uint64_t id, const String &p_reason) {
	String &reason = refusals_[id];
	if (reason == p_reason) {
		// The same error has already been printed.
		return;
	}
	reason = p_reason;
	ERR_PRINT(p_reason);
	update_warnings();
}

bool ScatterGroundMeshes::start_rereading() {
	if (!is_stale_) {
		watch_.mark_all_changed(true);
	}
	return true;
}

} // namespace thicket
