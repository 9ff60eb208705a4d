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
	take_list();
}

TypedArray<ScatterGround> ScatterGroundCombined::get_grounds() const { return grounds_; }

std::vector<std::uint64_t> ScatterGroundCombined::listed() const {
	std::vector<std::uint64_t> ids;
	for (std::int64_t index = 0; index < grounds_.size(); ++index) {
		const Ref<ScatterGround> ground = grounds_[index];
		ids.push_back(ground.is_valid() ? static_cast<std::uint64_t>(ground->get_instance_id()) : 0);
	}
	return ids;
}

/// Determines the parts if the list has changed. Emits signals.
void ScatterGroundCombined::take_list() {
	std::vector<std::uint64_t> ids = listed();
	if (ids == listed_) {
		return;
	}
	const Ref<ScatterGround> keep_alive(this);
	Parts next;
	{
		const std::lock_guard lock(parts_mutex);
		for (std::int64_t index = 0; index < grounds_.size(); ++index) {
			const Ref<ScatterGround> ground = grounds_[index];
			const bool repeated = std::ranges::find(next, ground, &Part::ground) != next.end();
			if (ground.is_valid() && ground->contains(this)) {
				ERR_PRINT(cycle_problem(index));
			} else if (ground.is_valid() && !repeated) {
				next.push_back({index, ground});
			}
		}
		listed_ = std::move(ids);
		std::swap(parts_, next);
	}
	watch_parts(next, false);
	watch_parts(parts_, true);
	update_uses();
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

std::optional<ScatterGroundCombined::Use> ScatterGroundCombined::next_to_leave() const {
	const auto found = std::ranges::find_if(uses_, [this](const Use &use) {
		return !has_part(use.ground) || std::ranges::find(hosts(), use.node, &GroundHost::node) == hosts().end();
	});
	return found != uses_.end() ? std::optional(*found) : std::nullopt;
}

/// Finds the next host to register with a part. Returns its index in `hosts`.
std::optional<std::size_t> ScatterGroundCombined::next_to_enter(Use &r_use) const {
	for (std::size_t host = 0; host < hosts().size(); ++host) {
		for (const Part &part : parts_) {
			r_use = {part.ground, hosts()[host].node};
			if (std::ranges::find(uses_, r_use) == uses_.end()) {
				return host;
			}
		}
	}
	return std::nullopt;
}

/// Registers all hosts with all parts and unregisters former ones. Each call emits signals, whose
/// handlers may change the parts and the hosts.
void ScatterGroundCombined::update_uses() {
	const Ref<ScatterGround> keep_alive(this);
	while (const std::optional<Use> former = next_to_leave()) {
		uses_.erase(std::ranges::find(uses_, *former));
		former->ground->leave(former->node);
	}
	Use use;
	while (const std::optional<std::size_t> host = next_to_enter(use)) {
		uses_.push_back(use);
		use.ground->enter(use.node, hosts()[*host].frame());
	}
}

void ScatterGroundCombined::hosts_changed(bool) { update_uses(); }

void ScatterGroundCombined::offset_changed(const GroundHost &host) {
	each_part([&](const Part &part) { part.ground->set_world_frame(host.node, host.frame()); });
}

void ScatterGroundCombined::follow() {
	take_list();
	each_part([this](const Part &part) { part.ground->follow_scene(deadline()); });
}

bool ScatterGroundCombined::distrust() {
	bool all = true;
	each_part([&all](const Part &part) { all = part.ground->read_again() && all; });
	return all;
}

/// A node that uses this ground calls this for each signal. Only the part that emitted the signal
/// has to search for its source.
void ScatterGroundCombined::search_again() {
	const Ref<ScatterGround> emitter = emitter_;
	each_part([&emitter](const Part &part) {
		if (emitter.is_null() || emitter == part.ground) {
			part.ground->search_again();
		}
	});
}

void ScatterGroundCombined::finish_reading() {
	const Ref<ScatterGround> keep_alive(this);
	take_list();
	each_part([](const Part &part) { part.ground->finish_reading(); });
}

void ScatterGroundCombined::part_changed() { emit_changed(); }

void ScatterGroundCombined::part_ground_changed(const Rect2 &p_rect, int64_t p_ground) {
	const Ref<ScatterGround> keep_alive(this);
	const auto found = std::ranges::find_if(parts_,
			[p_ground](const Part &part) { return static_cast<int64_t>(part.ground->get_instance_id()) == p_ground; });
	if (found == parts_.end()) {
		return; // A call from another thread, which was delayed.
	}
	const Ref<ScatterGround> outer = std::exchange(emitter_, found->ground);
	emit_ground_changed(p_rect);
	emitter_ = outer;
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
