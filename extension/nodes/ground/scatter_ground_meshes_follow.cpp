// How a ground of meshes follows the scene: a change is detected, its meshes are copied in steps, a worker builds them, and hosts are
// notified of changed ground.

#include "nodes/ground/scatter_ground_meshes.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/ground/changed_areas.hpp"

#include <godot_cpp/classes/scene_tree.hpp>
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

/// The problem of a mesh, in a sentence or two that name its node.
String refusal_of(const String &p_name, const MeshReading &reading) {
	const bool misplaced = std::string_view(reading.status.property) == "corners" &&
			(reading.status.code == ErrorCode::not_finite || reading.status.code == ErrorCode::out_of_range);
	const String remedy = " Until then its ground is unchanged.";
	if (misplaced) {
		const glm::dvec3 &at = reading.refused_corner;
		return vformat("%s: the mesh of \"%s\" has a corner at (%s, %s, %s): each coordinate must be finite and at "
					   "most %d m "
					   "from the world's origin. Fix the mesh or the node's transform.",
					   ScatterGroundMeshes::class_name, p_name, at.x, at.y, at.z,
					   static_cast<std::int64_t>(TriangleTerrain::max_extent)) +
				remedy;
	}
	return vformat("%s: the mesh of \"%s\" cannot be ground: ", ScatterGroundMeshes::class_name, p_name) +
			String(describe(reading.status).c_str()) +
			vformat(". It may have %d triangles, and indices of its own vertices only. Fix the mesh, or divide it.",
					static_cast<std::int64_t>(TriangleTerrain::max_triangles)) +
			remedy;
}

/// The world in a list that is the same as `world`, or was before the work; null if there is none.
const GroundWorld *find_world(const std::vector<GroundWorld> &worlds, const GroundWorld &world) {
	const auto found = std::ranges::find_if(worlds,
			[&](const GroundWorld &other) { return other.offset == world.offset && other.before == world.parts; });
	return found != worlds.end() ? &*found : nullptr;
}

} // namespace

bool ScatterGroundMeshes::is_pending(std::uint64_t host) const {
	if (!is_in_scene()) {
		return false;
	}
	const auto world = worlds_.find(host);
	return stale_ || reading_all_ || world == worlds_.end() || world->second.ground == nullptr;
}

bool ScatterGroundMeshes::is_behind() const {
	const bool pending = std::ranges::any_of(hosts(), [this](const GroundHost &host) { return is_pending(host.id); });
	return pending || (is_in_scene() && (watch_.restless() || !queue_.empty() || !readings_.empty() || building_));
}

void ScatterGroundMeshes::follow() {
	figures_.checks = 0;
	if (!is_in_scene()) {
		return;
	}
	if (builder_.finish(false)) {
		take_built();
		return; // A script that was called may have done anything.
	}
	if (!stale_) {
		if (first_node()->get_tree()->get_node_count_in_group(group_) != listed_) {
			list_members(true);
		}
		figures_.checks = watch_.look(look());
	}
	if (builder_.busy()) {
		return;
	}
	if (stale_) {
		begin();
	} else if (queue_.empty() && watch_.due()) {
		list_members(true); // One node may have been added while a different one was removed.
		const std::set<std::uint64_t> changed = watch_.take_changed();
		queue_.assign(changed.rbegin(), changed.rend());
	}
	add_worlds();
	read_some(deadline());
}

void ScatterGroundMeshes::finish_reading() {
	const auto pending = [this] {
		return std::ranges::any_of(hosts(), [this](const GroundHost &host) { return is_pending(host.id); });
	};
	// Twice, because the meshes that are being built may belong to a previous group. If a script sets further groups in between, they are
	// read a frame later.
	for (int round = 0; round < 2 && pending(); ++round) {
		if (builder_.finish(true)) {
			take_built();
		} else {
			if (stale_) {
				begin();
			}
			add_worlds();
			build(true);
		}
	}
}

/// Lists the group, and queues all of it for reading.
void ScatterGroundMeshes::begin() {
	builder_.finish(true);
	stale_ = false;
	reading_all_ = true;
	list_members(false);
	watch_.forget_changes();
	add_worlds();
	queue_all();
}

/// Queues all current and former instances of the group.
void ScatterGroundMeshes::queue_all() {
	const std::vector<std::uint64_t> listed = watch_.ids();
	std::set<std::uint64_t> all(listed.begin(), listed.end());
	for (const auto &[host, world] : worlds_) {
		for (const auto &[id, part] : *world.parts) {
			all.insert(id);
		}
	}
	reader_.cancel();
	queue_.assign(all.rbegin(), all.rend());
}

/// Each host has a world. Hosts with the same position of the origin share it.
void ScatterGroundMeshes::add_worlds() {
	for (const GroundHost &host : hosts()) {
		const auto found = worlds_.find(host.id);
		if (found != worlds_.end() && found->second.ground != nullptr) {
			found->second.offset = host.offset;
			continue;
		}
		const auto same = std::ranges::find_if(hosts(), [&](const GroundHost &other) {
			const auto world = worlds_.find(other.id);
			return other.offset == host.offset && world != worlds_.end() && world->second.ground != nullptr;
		});
		if (same != hosts().end()) {
			// For the same position of the origin, the ground is the same.
			worlds_[host.id] = worlds_.at(same->id);
		} else if (found == worlds_.end()) {
			worlds_[host.id] = {host.offset, std::make_shared<GroundMeshes>(), nullptr, nullptr, {}, {}};
			queue_all();
		} else {
			found->second.offset = host.offset;
		}
	}
}

/// Processes the next instances of the queue, until the deadline. After the last of them, all meshes that were read are passed to a worker.
void ScatterGroundMeshes::read_some(Clock::time_point deadline) {
	bool has_read = false;
	for (std::size_t looked = 0; !queue_.empty() && looked < GroundWatch::nodes_per_frame;) {
		if (has_read && Clock::now() >= deadline) {
			return;
		}
		if (reader_.busy()) {
			has_read = true;
			read_step();
		} else {
			plan_next();
			++looked;
		}
	}
	const bool has_work = reading_all_ || !readings_.empty() || !gone_.empty() || !unneeded_.empty() || lacks_ground();
	if (queue_.empty() && has_work) {
		build(false);
	}
}

bool ScatterGroundMeshes::lacks_ground() const {
	return std::ranges::any_of(worlds_, [](const auto &world) { return world.second.ground == nullptr; });
}

/// Reads all queued instances, and makes a worker build everything that was read.
void ScatterGroundMeshes::build(bool wait) {
	while (wait && !queue_.empty()) {
		if (reader_.busy()) {
			read_step();
		} else {
			plan_next();
		}
	}
	if (builder_.busy()) {
		return; // A mesh's script has started other work.
	}
	MeshWork work{std::exchange(readings_, {}), std::exchange(gone_, {}), {}, std::exchange(unneeded_, {})};
	building_ = reading_all_ || !work.readings.empty() || !work.gone.empty() || lacks_ground();
	for (const auto &[host, world] : worlds_) {
		if (building_ && find_world(work.worlds, world) == nullptr) {
			work.worlds.push_back(world);
			work.worlds.back().before = world.parts;
		}
	}
	builder_.start(std::move(work), wait);
	if (wait && builder_.finish(true)) {
		take_built();
	}
}

/// Takes the last instance out of the queue, unless its mesh must be read.
void ScatterGroundMeshes::plan_next() {
	const std::uint64_t id = queue_.back();
	queue_.pop_back(); // First, because a refusal may be reported to scripts, which may do anything.
	if (!plan(id)) {
		queue_.push_back(id);
	}
}

/// Records the work for an instance, for the worlds in which it has changed. False if its mesh must be read first.
bool ScatterGroundMeshes::plan(std::uint64_t id) {
	const Variant *watched = watch_.node(id);
	const Variant node = watched != nullptr ? *watched : Variant();
	Object *source = nullptr;
	GroundSight sight = look()(node, source);
	if (sight.source == 0) {
		gone_.push_back(id);
		refusals_.erase(id);
		return true;
	}
	if (!is_finite(sight.frame)) {
		refuse(id,
				vformat("%s: the global_transform of \"%s\" must be finite. Until then its ground is unchanged.",
						class_name, name_of(node)));
		return true;
	}
	const FreshCopy fresh = std::exchange(fresh_, {});
	const bool just_read = fresh.copy != nullptr && fresh.id == id;
	// A mesh that changes whenever it is read keeps the version at which it was read.
	sight.version = just_read ? fresh.version : watch_.version(sight.source);
	std::vector<MeshReading> readings = readings_of(id, sight);
	if (readings.empty()) {
		// It is unchanged in all worlds.
		refusals_.erase(id);
		return true;
	}
	const auto known = copies_.find(sight.source);
	std::shared_ptr<const MeshCopy> copy = just_read ? fresh.copy : nullptr;
	if (!just_read && known != copies_.end() && known->second.first == sight.version) {
		copy = known->second.second.lock();
	}
	if (copy == nullptr) {
		reader_.start(Ref<Mesh>(Object::cast_to<Mesh>(source)), sight.version);
		return false;
	}
	for (MeshReading &reading : readings) {
		reading.copy = copy;
		readings_.push_back(std::move(reading));
	}
	return true;
}

std::vector<MeshReading> ScatterGroundMeshes::readings_of(std::uint64_t id, const GroundSight &sight) const {
	std::vector<MeshReading> added;
	for (const auto &[host, world] : worlds_) {
		const auto part = world.parts->find(id);
		const std::shared_ptr<const GroundMesh> before = part != world.parts->end() ? part->second : nullptr;
		const bool begun = std::ranges::find(added, world.offset, &MeshReading::offset) != added.end();
		if (!begun && (before == nullptr || !same_in_world(before->sight, before->offset, sight, world.offset))) {
			added.push_back({id, sight, world.offset, nullptr, before, {}, glm::dvec3(0.0), nullptr});
		}
	}
	return added;
}

/// Reads one surface of the mesh of the queue's last instance.
void ScatterGroundMeshes::read_step() {
	const std::uint64_t source = reader_.source();
	const std::uint64_t version = reader_.version();
	if (const std::shared_ptr<const MeshCopy> copy = reader_.step(); copy != nullptr) {
		++figures_.reads;
		copies_[source] = {version, copy};
		fresh_ = {queue_.empty() ? 0 : queue_.back(), version, copy};
	}
}

/// Applies the built meshes to the ground.
void ScatterGroundMeshes::take_built() {
	const bool was_empty = is_empty();
	const MeshWork work = builder_.take();
	if (std::exchange(building_, false)) {
		reading_all_ = false;
	}
	std::vector<Rect> areas;
	for (auto &[id, world] : worlds_) {
		const GroundWorld *built = find_world(work.worlds, world);
		if (built == nullptr) {
			continue;
		}
		report(class_name, built->status);
		if (world.ground != nullptr) {
			for (const Rect &area : built->changes) {
				add_changed_area(areas, area);
			}
		}
		unneeded_.push_back(world.parts);
		unneeded_.push_back(world.ground);
		world = *built;
		world.before = nullptr;
		if (world.ground == nullptr) {
			world.ground = std::make_shared<TriangleParts>(); // There is nothing to wait for: its error was printed.
		}
	}
	std::erase_if(copies_, [](const auto &copy) { return copy.second.second.expired(); });
	last_ = !hosts().empty() && worlds_.contains(hosts().front().id) ? worlds_[hosts().front().id].ground : last_;
	take_refusals(work);
	tell(areas, was_empty);
}

/// A mesh that was already refused is only reported again for a different reason.
void ScatterGroundMeshes::take_refusals(const MeshWork &work) {
	for (const MeshReading &reading : work.readings) {
		const Variant *node = watch_.node(reading.id);
		if (reading.status.ok()) {
			refusals_.erase(reading.id);
		} else if (node != nullptr) {
			refuse(reading.id, refusal_of(name_of(*node), reading));
		}
	}
}

void ScatterGroundMeshes::refuse(std::uint64_t id, const String &p_why) {
	String &why = refusals_[id];
	if (why == p_why) {
		// This reason was already printed.
		return;
	}
	why = p_why;
	ERR_PRINT(p_why);
	update_warnings();
}

bool ScatterGroundMeshes::distrust() {
	if (!stale_) {
		watch_.touch_all(true);
	}
	return true;
}

} // namespace thicket
