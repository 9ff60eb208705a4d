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

/// The interval at which the ground is updated for nodes that do not come to rest.
constexpr std::chrono::milliseconds longest_wait(400);

/// The number of physics frames after which a body has certainly reached the position of its node.
constexpr std::uint64_t physics_frames = 2;

/// The relative precision that a coordinate may lose when a scene is moved: a few bits of a float.
constexpr double lost_precision = 1.0 / (1 << 21);

} // namespace

bool same_in_world(const GroundNodeState &a, glm::dvec3 offset_a, const GroundNodeState &b, glm::dvec3 offset_b) {
	if (offset_a == offset_b) {
		return a == b;
	}
	if (a.source != b.source || a.version != b.version || !(a.frame.basis == b.frame.basis)) {
		return false;
	}
	const glm::dvec3 at_a = to_core(a.frame.origin);
	const glm::dvec3 at_b = to_core(b.frame.origin);
	for (int axis = 0; axis < 3; ++axis) {
		const double moved = (at_a[axis] + offset_a[axis]) - (at_b[axis] + offset_b[axis]);
		const double reach =
				std::max({std::abs(at_a[axis]), std::abs(at_b[axis]), std::abs(offset_a[axis] - offset_b[axis])});
		if (!(std::abs(moved) <= lost_precision * reach)) {
			return false;
		}
	}
	return true;
}

void GroundWatch::add(std::uint64_t id, const Variant &p_node, const ReadState &read_state, bool changed) {
	const auto [found, is_new] = entries_.try_emplace(id, Entry{p_node, {}});
	if (!is_new) {
		return;
	}
	Object *source = nullptr;
	GroundNodeState &seen = found->second.seen;
	seen = read_state(p_node, source);
	use(seen.source, source);
	seen.version = version(seen.source);
	if (changed && seen.source != 0) {
		touch(id, false);
	}
}

void GroundWatch::remove(std::uint64_t id) {
	const auto found = entries_.find(id);
	if (found != entries_.end()) {
		const std::uint64_t source = found->second.seen.source;
		entries_.erase(found);
		if (source != 0) {
			touch(id, false);
		}
		drop(source);
	}
}

void GroundWatch::clear() {
	for (const auto &[id, source] : std::exchange(sources_, {})) {
		watch(source.object.get_validated_object(), "changed", owner_, method_, false);
	}
	entries_.clear();
	changed_.clear();
}

const Variant *GroundWatch::node(std::uint64_t id) const {
	const auto found = entries_.find(id);
	return found != entries_.end() ? &found->second.node : nullptr;
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
	auto at = entries_.lower_bound(next_);
	for (std::size_t count = 0; count < max_count; ++count) {
		at = at != entries_.end() ? at : entries_.begin();
		auto &[id, entry] = *at;
		Object *source = nullptr;
		GroundNodeState now = read_state(entry.node, source);
		now.version = version(now.source);
		if (now == entry.seen) {
			rest(id);
		} else {
			// Call `use` before `drop`, because the old source may be the same.
			use(now.source, source);
			drop(entry.seen.source);
			now.version = version(now.source);
			touch(id, now.source != 0 && entry.seen.source != 0);
			entry.seen = now;
		}
		++at;
	}
	next_ = at != entries_.end() ? at->first : 0;
	return max_count;
}

void GroundWatch::use(std::uint64_t id, Object *p_source) {
	if (id == 0 || p_source == nullptr) {
		return;
	}
	Source &source = sources_[id];
	if (source.users++ == 0) {
		source.version = ++versions_;
		source.object = Variant(p_source);
		watch(p_source, "changed", owner_, method_, true, static_cast<int64_t>(id));
	}
}

void GroundWatch::drop(std::uint64_t id) {
	const auto found = sources_.find(id);
	if (found != sources_.end() && --found->second.users == 0) {
		watch(found->second.object.get_validated_object(), "changed", owner_, method_, false);
		sources_.erase(found);
	}
}

void GroundWatch::source_changed(std::uint64_t source) {
	const auto found = sources_.find(source);
	if (found != sources_.end()) {
		found->second.version = ++versions_;
	}
}

std::uint64_t GroundWatch::version(std::uint64_t source) const {
	const auto found = sources_.find(source);
	return found != sources_.end() ? found->second.version : 0;
}

void GroundWatch::touch(std::uint64_t id, bool moves) {
	const Clock::time_point now = Clock::now();
	const auto [found, is_new] = changed_.try_emplace(id, Change{now, now, 0, moves, false});
	found->second.last = now;
	found->second.frame = Engine::get_singleton()->get_physics_frames();
	found->second.moves = moves;
	found->second.rests = false;
}

/// Records that a check has found no change to a node.
void GroundWatch::rest(std::uint64_t id) {
	const auto found = changed_.find(id);
	if (found != changed_.end()) {
		found->second.rests = Clock::now() - found->second.last >= rest_time;
	}
}

void GroundWatch::touch_all(bool distrust) {
	for (auto &[id, source] : sources_) {
		source.version = distrust ? ++versions_ : source.version;
	}
	for (auto &[id, entry] : entries_) {
		entry.seen.version = version(entry.seen.source);
		touch(id, true);
	}
}

std::set<std::uint64_t> GroundWatch::take_changed() {
	const Clock::time_point now = Clock::now();
	const std::uint64_t frame = Engine::get_singleton()->get_physics_frames();
	std::set<std::uint64_t> due;
	for (auto at = changed_.begin(); at != changed_.end();) {
		auto &[id, change] = *at;
		const bool at_rest = (!change.moves || change.rests) && frame >= change.frame + physics_frames;
		const bool overdue = change.moves && now - change.first >= longest_wait;
		if (at_rest || overdue) {
			due.insert(id);
		}
		if (at_rest) {
			at = changed_.erase(at);
		} else {
			change.first = overdue ? now : change.first;
			++at;
		}
	}
	return due;
}

} // namespace thicket
