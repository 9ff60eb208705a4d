#include "nodes/ground/ground_watch.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/classes/engine.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The time without a change after which a node is considered at rest.
constexpr std::chrono::milliseconds rest_time(100);

/// The maximum time until the ground is updated for a node that does not come to rest.
constexpr std::chrono::milliseconds max_wait(400);

/// The number of physics frames after which a body has certainly reached the position of its node.
constexpr std::uint64_t physics_frames = 2;

/// The relative rounding error that moving a scene may cause in a coordinate: a few bits of a float.
constexpr double rounding_tolerance = 1.0 / (1 << 21);

} // namespace

bool same_in_world(const GroundNodeState &a, glm::dvec3 offset_a, const GroundNodeState &b, glm::dvec3 offset_b) {
	if (offset_a == offset_b) {
		return a == b;
	}
	if (a.source != b.source || a.version != b.version || !(a.frame.basis == b.frame.basis)) {
		return false;
	}
	const glm::dvec3 position_a = to_core(a.frame.origin);
	const glm::dvec3 position_b = to_core(b.frame.origin);
	for (int axis = 0; axis < 3; ++axis) {
		const double difference = (position_a[axis] + offset_a[axis]) - (position_b[axis] + offset_b[axis]);
		const double magnitude = std::max(
				{std::abs(position_a[axis]), std::abs(position_b[axis]), std::abs(offset_a[axis] - offset_b[axis])});
		if (!(std::abs(difference) <= rounding_tolerance * magnitude)) {
			return false;
		}
	}
	return true;
}

void GroundWatch::add(std::uint64_t id, const Variant &p_node, const ReadState &read_state, bool as_changed) {
	const auto [entry, is_new] = entries_.try_emplace(id, Entry{p_node, {}});
	if (!is_new) {
		return;
	}
	Object *source = nullptr;
	GroundNodeState &state = entry->second.state;
	state = read_state(p_node, source);
	use(state.source, source);
	state.version = version(state.source);
	if (as_changed && state.source != 0) {
		mark_changed(id, false);
	}
}

void GroundWatch::remove(std::uint64_t id) {
	const auto entry = entries_.find(id);
	if (entry != entries_.end()) {
		const std::uint64_t source = entry->second.state.source;
		entries_.erase(entry);
		if (source != 0) {
			mark_changed(id, false);
		}
		drop(source);
	}
}

void GroundWatch::clear() {
	for (const auto &[id, source] : std::exchange(sources_, {})) {
		watch(source.object.get_validated_object(), "changed", owner_, method_, false);
	}
	entries_.clear();
	changes_.clear();
}

const Variant *GroundWatch::node(std::uint64_t id) const {
	const auto entry = entries_.find(id);
	return entry != entries_.end() ? &entry->second.node : nullptr;
}

std::vector<std::uint64_t> GroundWatch::ids() const {
	std::vector<std::uint64_t> result;
	for (const auto &[id, entry] : entries_) {
		result.push_back(id);
	}
	return result;
}

std::size_t GroundWatch::check_next(const ReadState &read_state) {
	const std::size_t max_count = std::min(nodes_per_frame, entries_.size());
	auto iterator = entries_.lower_bound(next_id_);
	for (std::size_t count = 0; count < max_count; ++count) {
		iterator = iterator != entries_.end() ? iterator : entries_.begin();
		auto &[id, entry] = *iterator;
		Object *source = nullptr;
		GroundNodeState state = read_state(entry.node, source);
		state.version = version(state.source);
		if (state == entry.state) {
			record_rest(id);
		} else {
			// Call `use` before `drop`, because the old source may be the same.
			use(state.source, source);
			drop(entry.state.source);
			state.version = version(state.source);
			mark_changed(id, state.source != 0 && entry.state.source != 0);
			entry.state = state;
		}
		++iterator;
	}
	next_id_ = iterator != entries_.end() ? iterator->first : 0;
	return max_count;
}

void GroundWatch::use(std::uint64_t id, Object *p_source) {
	if (id == 0 || p_source == nullptr) {
		return;
	}
	Source &source = sources_[id];
	if (source.users++ == 0) {
		source.version = ++last_version_;
		source.object = Variant(p_source);
		watch(p_source, "changed", owner_, method_, true, static_cast<int64_t>(id));
	}
}

void GroundWatch::drop(std::uint64_t id) {
	const auto entry = sources_.find(id);
	if (entry != sources_.end() && --entry->second.users == 0) {
		watch(entry->second.object.get_validated_object(), "changed", owner_, method_, false);
		sources_.erase(entry);
	}
}

void GroundWatch::source_changed(std::uint64_t source) {
	const auto entry = sources_.find(source);
	if (entry != sources_.end()) {
		entry->second.version = ++last_version_;
	}
}

std::uint64_t GroundWatch::version(std::uint64_t source) const {
	const auto entry = sources_.find(source);
	return entry != sources_.end() ? entry->second.version : 0;
}

void GroundWatch::mark_changed(std::uint64_t id, bool may_move) {
	const Clock::time_point now = Clock::now();
	const auto [entry, is_new] = changes_.try_emplace(id, Change{now, now, 0, may_move, false});
	entry->second.last = now;
	entry->second.frame = Engine::get_singleton()->get_physics_frames();
	entry->second.may_move = may_move;
	entry->second.is_at_rest = false;
}

/// Records that a check has found no change to a node.
void GroundWatch::record_rest(std::uint64_t id) {
	const auto entry = changes_.find(id);
	if (entry != changes_.end()) {
		entry->second.is_at_rest = Clock::now() - entry->second.last >= rest_time;
	}
}

void GroundWatch::mark_all_changed(bool include_sources) {
	for (auto &[id, source] : sources_) {
		source.version = include_sources ? ++last_version_ : source.version;
	}
	for (auto &[id, entry] : entries_) {
		entry.state.version = version(entry.state.source);
		mark_changed(id, true);
	}
}

std::set<std::uint64_t> GroundWatch::take_changed() {
	const Clock::time_point now = Clock::now();
	const std::uint64_t frame = Engine::get_singleton()->get_physics_frames();
	std::set<std::uint64_t> due_ids;
	for (auto iterator = changes_.begin(); iterator != changes_.end();) {
		auto &[id, change] = *iterator;
		const bool is_at_rest = (!change.may_move || change.is_at_rest) && frame >= change.frame + physics_frames;
		const bool is_overdue = change.may_move && now - change.first >= max_wait;
		if (is_at_rest || is_overdue) {
			due_ids.insert(id);
		}
		if (is_at_rest) {
			iterator = changes_.erase(iterator);
		} else {
			change.first = is_overdue ? now : change.first;
			++iterator;
		}
	}
	return due_ids;
}

} // namespace thicket
