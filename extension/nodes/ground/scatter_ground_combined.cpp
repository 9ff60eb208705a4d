#include "nodes/ground/scatter_ground_combined.hpp"

#include "core/base/mutex.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <mutex>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Guards the parts of all combinations while they are searched for cycles, because two threads
/// could make two combinations parts of each other.
Mutex parts_mutex;

String cycle_problem(std::int64_t index) {
	return vformat("ScatterGroundCombined.grounds[%d] must not be or contain this ground itself. Assign another "
				   "ScatterGround.",
			index);
}

} // namespace

void ScatterGroundCombined::set_grounds(const TypedArray<ScatterGround> &p_grounds) {
	for (std::int64_t index = 0; index < p_grounds.size(); ++index) {
		const Ref<ScatterGround> ground = p_grounds[index];
		const std::lock_guard lock(parts_mutex);
		if (ground.is_valid() && ground->contains(this)) {
			ERR_PRINT(cycle_problem(index));
			return;
		}
	}
	grounds_ = p_grounds;
	update_parts();
}

TypedArray<ScatterGround> ScatterGroundCombined::get_grounds() const { return grounds_; }

std::vector<std::uint64_t> ScatterGroundCombined::listed_ids() const {
	std::vector<std::uint64_t> ids;
	for (std::int64_t index = 0; index < grounds_.size(); ++index) {
		const Ref<ScatterGround> ground = grounds_[index];
		ids.push_back(ground.is_valid() ? static_cast<std::uint64_t>(ground->get_instance_id()) : 0);
	}
	return ids;
}

/// Determines the parts if the list has changed. Emits signals.
void ScatterGroundCombined::update_parts() {
	std::vector<std::uint64_t> ids = listed_ids();
	if (ids == listed_ids_) {
		return;
	}
	const Ref<ScatterGround> keep_alive(this);
	Parts parts;
	{
		const std::lock_guard lock(parts_mutex);
		for (std::int64_t index = 0; index < grounds_.size(); ++index) {
			const Ref<ScatterGround> ground = grounds_[index];
			const bool is_repeated = std::ranges::find(parts, ground, &Part::ground) != parts.end();
			if (ground.is_valid() && ground->contains(this)) {
				ERR_PRINT(cycle_problem(index));
			} else if (ground.is_valid() && !is_repeated) {
				parts.push_back({index, ground});
			}
		}
		listed_ids_ = std::move(ids);
		std::swap(parts_, parts);
	}
	watch_parts(parts, false); // After the swap, these are the former parts.
	watch_parts(parts_, true);
	update_registrations();
	notify_property_list_changed();
	emit_changed();
}

void ScatterGroundCombined::watch_parts(const Parts &parts, bool p_watch) {
	for (const Part &part : parts) {
		const auto id = static_cast<int64_t>(part.ground->get_instance_id());
		watch(part.ground.ptr(), "changed", this, "_part_changed", p_watch);
		watch(part.ground.ptr(), "ground_changed", this, "_part_ground_changed", p_watch, id);
	}
}

bool ScatterGroundCombined::has_part(const Ref<ScatterGround> &p_ground) const {
	return std::ranges::find(parts_, p_ground, &Part::ground) != parts_.end();
}

std::optional<ScatterGroundCombined::Registration> ScatterGroundCombined::next_to_unregister() const {
	const auto match = std::ranges::find_if(registrations_, [this](const Registration &registration) {
		return !has_part(registration.ground) ||
				std::ranges::find(hosts(), registration.node, &GroundHost::node) == hosts().end();
	});
	return match != registrations_.end() ? std::optional(*match) : std::nullopt;
}

/// Finds the next host to register with a part. Returns its index in `hosts`.
std::optional<std::size_t> ScatterGroundCombined::next_to_register(Registration &r_registration) const {
	for (std::size_t host = 0; host < hosts().size(); ++host) {
		for (const Part &part : parts_) {
			r_registration = {part.ground, hosts()[host].node};
			if (std::ranges::find(registrations_, r_registration) == registrations_.end()) {
				return host;
			}
		}
	}
	return std::nullopt;
}

/// Registers all hosts with all parts and unregisters former ones. Each call emits signals, whose
/// handlers may change the parts and the hosts.
void ScatterGroundCombined::update_registrations() {
	const Ref<ScatterGround> keep_alive(this);
	while (const std::optional<Registration> old_registration = next_to_unregister()) {
		registrations_.erase(std::ranges::find(registrations_, *old_registration));
		old_registration->ground->leave(old_registration->node);
	}
	Registration registration;
	while (const std::optional<std::size_t> host = next_to_register(registration)) {
		registrations_.push_back(registration);
		registration.ground->enter(registration.node, hosts()[*host].frame());
	}
}

void ScatterGroundCombined::hosts_changed(bool) { update_registrations(); }

void ScatterGroundCombined::offset_changed(const GroundHost &host) {
	for_each_part([&](const Part &part) { part.ground->set_world_frame(host.node, host.frame()); });
}

void ScatterGroundCombined::follow() {
	update_parts();
	for_each_part([this](const Part &part) { part.ground->follow_scene(deadline()); });
}

bool ScatterGroundCombined::start_rereading() {
	bool all_reread = true;
	for_each_part([&all_reread](const Part &part) { all_reread = part.ground->reread() && all_reread; });
	return all_reread;
}

/// A node that uses this ground calls this for each signal. Only the part that emitted the signal
/// has to search for its source.
void ScatterGroundCombined::search_again() {
	const Ref<ScatterGround> emitter = emitter_;
	for_each_part([&emitter](const Part &part) {
		if (emitter.is_null() || emitter == part.ground) {
			part.ground->search_again();
		}
	});
}

void ScatterGroundCombined::finish_reading() {
	const Ref<ScatterGround> keep_alive(this);
	update_parts();
	for_each_part([](const Part &part) { part.ground->finish_reading(); });
}

void ScatterGroundCombined::part_changed() { emit_changed(); }

void ScatterGroundCombined::part_ground_changed(const Rect2 &p_rect, int64_t p_ground) {
	const Ref<ScatterGround> keep_alive(this);
	const auto match = std::ranges::find_if(parts_,
			[p_ground](const Part &part) { return static_cast<int64_t>(part.ground->get_instance_id()) == p_ground; });
	if (match == parts_.end()) {
		return; // A call from another thread, which was delayed.
	}
	const Ref<ScatterGround> previous_emitter = std::exchange(emitter_, match->ground);
	emit_ground_changed(p_rect);
	emitter_ = previous_emitter;
}

void ScatterGroundCombined::_bind_methods() {
	using Self = ScatterGroundCombined;
	bind_guarded<&Self::set_grounds>(D_METHOD("set_grounds", "grounds"));
	bind_guarded<&Self::get_grounds>(D_METHOD("get_grounds"));
	bind_guarded<&Self::part_changed>(ThreadUse::relayed, D_METHOD("_part_changed"));
	bind_guarded<&Self::part_ground_changed>(ThreadUse::relayed, D_METHOD("_part_ground_changed", "rect", "ground"));
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "grounds", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterGround", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_grounds", "get_grounds");
}

} // namespace thicket
