#include "core/state/instance_state_content.hpp"

#include "core/base/guard.hpp"
#include "core/base/reserve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace thicket {

namespace {

/// Returns the length of the longest column of the basis.
double scale_of(const AddedInstance &instance) {
	double squared = 0.0;
	for (int column = 0; column < 3; ++column) {
		const glm::dvec3 axis(instance.basis[column]);
		squared = std::max(squared, axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
	}
	return std::sqrt(squared);
}

glm::dvec2 square_position(const AddedInstance &instance) { return {instance.position.x, instance.position.z}; }

} // namespace

StateRecord::Entry InstanceState::Content::entry(std::uint64_t id) const {
	Entry entry;
	entry.removed = removed.contains(id);
	entry.until = entry.removed ? removed.value(id) : 0.0;
	if (const Placed *placed = added.value(id).get()) {
		entry.instance = &placed->instance;
		entry.placed_at = placed->at;
	}
	if (const Data *stored = data.value(id).get()) {
		entry.data = stored->bytes;
		entry.data_at = stored->at;
	}
	return entry;
}

const AddedInstance *InstanceState::Content::instance_of(std::uint64_t id) const {
	const Placed *placed = added.value(id).get();
	return placed != nullptr ? &placed->instance : nullptr;
}

StateRecord::Entry InstanceState::Content::placed_as(std::uint64_t id, const AddedInstance &instance) const {
	Entry target = entry(id);
	const bool is_same = target.instance != nullptr && *target.instance == instance;
	target.placed_at = is_same ? target.placed_at : time_of_write(target.instance != nullptr ? target.placed_at : -1.0);
	target.instance = &instance;
	return target;
}

double InstanceState::Content::time_of_write(double previous_time) const {
	// About a microsecond, in seconds. The number is a power of two, so that sums are exact.
	constexpr double step = 0x1p-20;
	if (time > previous_time) {
		return time;
	}
	const double next_time = previous_time + step > previous_time ? previous_time + step
																  : std::nextafter(previous_time, 2.0 * max_state_time);
	return std::min(next_time, max_state_time);
}

std::span<const std::uint8_t> InstanceState::Content::bytes_of(std::uint64_t id) const {
	const Data *stored = data.value(id).get();
	return stored != nullptr ? std::span<const std::uint8_t>(stored->bytes) : std::span<const std::uint8_t>();
}

std::unique_ptr<InstanceState::Content> InstanceState::Content::share() {
	auto other = std::make_unique<Content>();
	other->layers = layers;
	other->removed = removed.share();
	other->added = added.share();
	other->data = data.share();
	other->log.start_at(revision);
	other->revision = revision;
	other->origin = origin;
	other->known = known;
	other->time = time;
	other->is_completed = false;
	return other;
}

void InstanceState::Content::complete() {
	if (is_completed) {
		return;
	}
	added.for_each([this](std::uint64_t id, const SharedInstance &stored) {
		grid.insert(id, square_position(stored->instance));
	});
	due.reserve(removed.valued());
	gather_due();
	is_completed = true;
}

void InstanceState::Content::take_history(
		const Content &other, ChangeLog &r_log, std::uint64_t at, std::uint64_t first_note) noexcept {
	const std::uint64_t raise = other.revision - first_note;
	const Status status = guarded("changes", static_cast<double>(log.size()), [&] {
		if (other.log.knows(at)) {
			// `r_log` is an earlier version of the other log, so only the later changes are
			// appended.
			r_log.append(other.log, at, 0);
		} else {
			r_log = other.log;
		}
		r_log.append(log, first_note, raise);
	});
	revision += raise;
	log = std::move(r_log);
	if (!status.ok()) {
		log.start_at(revision);
	}
}

StateChange InstanceState::Content::change_one(
		std::uint64_t id, const Entry &target, const char *asked_for, double value) {
	std::vector<InstanceChange> changes;
	const Status status = guarded(asked_for, value, [&] {
		ReservedMemory reserved;
		plan(id, target, reserved);
		reserve(reserved, changes);
		change(id, target, reserved, changes);
		shrink();
	});
	return {status, !changes.empty()};
}

void InstanceState::Content::shrink() noexcept {
	removed.shrink();
	added.shrink();
	data.shrink();
}

/// Allocates the memory that `change` needs for one ID, except for the memory that `reserve`
/// allocates for the whole batch.
void InstanceState::Content::plan(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved) {
	bool data_stay = true;
	if (is_added(id)) {
		data_stay = plan_added(id, target, r_reserved);
	} else {
		plan_removed(id, target, r_reserved);
	}
	const Data *stored = data.value(id).get();
	const bool has_data = stored != nullptr;
	const bool existed = data_stay && has_data;
	const bool is_same = existed ? std::ranges::equal(stored->bytes, target.data) : target.data.empty();
	const bool later = is_same && existed && stored->at != target.data_at;
	if (is_same && existed == has_data && !later) {
		// Unchanged data needs no memory.
		return;
	}
	data.reserve_for(id, !has_data && !target.data.empty(), !target.data.empty(),
			r_reserved.new_ids != nullptr ? &r_reserved.new_ids->data : nullptr);
	if (is_same && !later) {
		return;
	}
	r_reserved.changes += later ? 0 : 1;
	layers.try_emplace(layer_of(id));
	if (!target.data.empty()) {
		r_reserved.data.emplace(
				id, std::make_shared<const Data>(Data{Bytes(target.data.begin(), target.data.end()), target.data_at}));
	}
}

void InstanceState::Content::plan_removed(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved) {
	const bool existed = removed.contains(id);
	const bool timed = target.removed && target.until > 0.0;
	r_reserved.due += timed ? 1 : 0;
	if (existed != target.removed || (existed && removed.value(id) != target.until)) {
		removed.reserve_for(
				id, !existed, timed, r_reserved.new_ids != nullptr ? &r_reserved.new_ids->removed : nullptr);
	}
	if (existed != target.removed) {
		++r_reserved.changes;
		layers.try_emplace(layer_of(id));
	}
}

/// Returns false if the current instance will be deleted along with its data. A moved instance
/// keeps its data.
bool InstanceState::Content::plan_added(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved) {
	const Placed *stored = added.value(id).get();
	const bool existed = stored != nullptr;
	const bool is_same =
			existed ? target.instance != nullptr && *target.instance == stored->instance : target.instance == nullptr;
	if (is_same && (!existed || stored->at == target.placed_at)) {
		return true;
	}
	added.reserve_for(id, !existed, true, r_reserved.new_ids != nullptr ? &r_reserved.new_ids->added : nullptr);
	if (target.instance != nullptr) {
		r_reserved.added.emplace(id, std::make_shared<const Placed>(Placed{*target.instance, target.placed_at}));
	}
	if (is_same) {
		return true;
	}
	r_reserved.changes += existed ? 1 : 0;
	if (target.instance != nullptr) {
		++r_reserved.changes;
		layers.try_emplace(target.instance->layer);
		r_reserved.grid.insert(id, square_position(*target.instance));
	}
	return !existed || target.instance != nullptr;
}

void InstanceState::Content::reserve(const ReservedMemory &reserved, std::vector<InstanceChange> &r_changes) {
	reserve_more(due, reserved.due);
	reserve_more(r_changes, reserved.changes);
}

void InstanceState::Content::change(std::uint64_t id, const Entry &target, ReservedMemory &r_reserved,
		std::vector<InstanceChange> &r_changes) noexcept {
	if (is_added(id)) {
		change_added(id, target, r_reserved, r_changes);
	} else {
		change_removed(id, target, r_changes);
	}
	change_data(id, target, r_reserved, r_changes);
}

void InstanceState::Content::change_removed(
		std::uint64_t id, const Entry &target, std::vector<InstanceChange> &r_changes) {
	const bool existed = removed.contains(id);
	if (target.removed && (!existed || removed.value(id) != target.until)) {
		removed.insert(id, target.until);
		plan_return(id, target.until);
		record(id);
	} else if (!target.removed && existed) {
		removed.erase(id);
		record(id);
	}
	if (existed == target.removed) {
		return;
	}
	Layer &layer = layers[layer_of(id)];
	layer.removed += target.removed ? 1 : -std::size_t{1};
	r_changes.push_back({id, target.removed ? InstanceChangeKind::removed : InstanceChangeKind::restored, {}});
}

void InstanceState::Content::change_added(
		std::uint64_t id, const Entry &entry, ReservedMemory &r_reserved, std::vector<InstanceChange> &r_changes) {
	const AddedInstance *target = entry.instance;
	const Placed *stored = added.value(id).get();
	const bool existed = stored != nullptr;
	if (existed ? target != nullptr && *target == stored->instance : target == nullptr) {
		if (existed && stored->at != entry.placed_at) {
			added.insert(id, std::move(r_reserved.added.find(id)->second));
			record(id);
		}
		return;
	}
	const bool moves = existed && target != nullptr;
	if (existed) {
		r_changes.push_back({id, moves ? InstanceChangeKind::left : InstanceChangeKind::removed, take_away(id)});
	}
	if (target != nullptr) {
		place(id, r_reserved);
		r_changes.push_back({id, moves ? InstanceChangeKind::moved : InstanceChangeKind::added, *target});
	} else {
		data.erase(id);
	}
	record(id);
}

void InstanceState::Content::place(std::uint64_t id, ReservedMemory &r_reserved) {
	const auto planned = r_reserved.added.find(id);
	const AddedInstance &instance = planned->second->instance;
	Layer &layer = layers[instance.layer];
	grid.take(r_reserved.grid, id, square_position(instance));
	layer.max_scale = std::max(layer.max_scale, scale_of(instance));
	++layer.added;
	added.insert(id, std::move(planned->second));
}

AddedInstance InstanceState::Content::take_away(std::uint64_t id) {
	const AddedInstance instance = *instance_of(id);
	added.erase(id);
	grid.erase(id, square_position(instance));
	Layer &layer = layers[instance.layer];
	--layer.added;
	layer.max_scale = layer.added > 0 ? layer.max_scale : 0.0;
	return instance;
}

void InstanceState::Content::change_data(
		std::uint64_t id, const Entry &entry, ReservedMemory &r_reserved, std::vector<InstanceChange> &r_changes) {
	const std::span<const std::uint8_t> target = entry.data;
	const Data *stored = data.value(id).get();
	const bool existed = stored != nullptr;
	if (existed ? std::ranges::equal(stored->bytes, target) : target.empty()) {
		if (existed && stored->at != entry.data_at) {
			data.insert(id, std::move(r_reserved.data.find(id)->second));
			record(id);
		}
		return;
	}
	if (!is_added(id)) {
		layers[layer_of(id)].with_data += target.empty() ? -std::size_t{1} : std::size_t{existed ? 0U : 1U};
	}
	if (target.empty()) {
		data.erase(id);
	} else {
		data.insert(id, std::move(r_reserved.data.find(id)->second));
	}
	record(id);
	const AddedInstance *placed = instance_of(id);
	r_changes.push_back({id, InstanceChangeKind::data, placed != nullptr ? *placed : AddedInstance()});
}

void InstanceState::Content::record(std::uint64_t id) {
	++revision;
	if (logging) {
		log.record(revision, id, size());
	}
}

void InstanceState::Content::plan_return(std::uint64_t id, double until) {
	if (until <= 0.0) {
		return;
	}
	constexpr std::size_t always_kept = 64;
	if (due.size() < 2 * removed.valued() + always_kept) {
		due.push_back({until, id});
		std::ranges::push_heap(due, std::greater<>());
		return;
	}
	gather_due(); // Most entries are outdated. The valid ones fit into the existing memory.
}

void InstanceState::Content::gather_due() {
	due.clear();
	removed.for_each([this](std::uint64_t id, double until) {
		if (until > 0.0) {
			due.push_back({until, id});
		}
	});
	std::ranges::make_heap(due, std::greater<>());
}

void InstanceState::Content::move_clock(double new_time, std::vector<InstanceChange> &r_changes) {
	ReservedMemory nothing;
	std::size_t max_count = 0;
	for_each_due(new_time, [&](std::uint64_t id) {
		removed.reserve_for(id, false, false, nullptr);
		++max_count;
	});
	reserve_more(r_changes, max_count);
	time = new_time;
	while (!due.empty() && due.front().time <= time) {
		const Due first = due.front();
		std::ranges::pop_heap(due, std::greater<>());
		due.pop_back();
		if (removed.value(first.id) == first.time) {
			Entry entry = this->entry(first.id);
			entry.removed = false;
			change(first.id, entry, nothing, r_changes);
		}
	}
	shrink();
}

} // namespace thicket
