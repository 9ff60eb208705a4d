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
	if (const Data *own = data.value(id).get()) {
		entry.data = own->bytes;
		entry.data_at = own->at;
	}
	return entry;
}

const AddedInstance *InstanceState::Content::instance_of(std::uint64_t id) const {
	const Placed *placed = added.value(id).get();
	return placed != nullptr ? &placed->instance : nullptr;
}

StateRecord::Entry InstanceState::Content::placed_as(std::uint64_t id, const AddedInstance &instance) const {
	Entry to = entry(id);
	const bool same = to.instance != nullptr && *to.instance == instance;
	to.placed_at = same ? to.placed_at : time_of_write(to.instance != nullptr ? to.placed_at : -1.0);
	to.instance = &instance;
	return to;
}

double InstanceState::Content::time_of_write(double former) const {
	// About a microsecond, in seconds. The number is a power of two, so that sums are exact.
	constexpr double step = 0x1p-20;
	if (time > former) {
		return time;
	}
	const double later = former + step > former ? former + step : std::nextafter(former, 2.0 * max_state_time);
	return std::min(later, max_state_time);
}

std::span<const std::uint8_t> InstanceState::Content::bytes_of(std::uint64_t id) const {
	const Data *own = data.value(id).get();
	return own != nullptr ? std::span<const std::uint8_t>(own->bytes) : std::span<const std::uint8_t>();
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
	added.for_each(
			[this](std::uint64_t id, const SharedInstance &own) { grid.insert(id, square_position(own->instance)); });
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

StateChange InstanceState::Content::change_one(std::uint64_t id, const Entry &to, const char *asked_for, double value) {
	std::vector<InstanceChange> changes;
	const Status status = guarded(asked_for, value, [&] {
		ReservedMemory reserved;
		plan(id, to, reserved);
		reserve(reserved, changes);
		change(id, to, reserved, changes);
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
void InstanceState::Content::plan(std::uint64_t id, const Entry &to, ReservedMemory &r_reserved) {
	bool data_stay = true;
	if (is_added(id)) {
		data_stay = plan_added(id, to, r_reserved);
	} else {
		plan_removed(id, to, r_reserved);
	}
	const Data *own = data.value(id).get();
	const bool holds = own != nullptr;
	const bool was = data_stay && holds;
	const bool same = was ? std::ranges::equal(own->bytes, to.data) : to.data.empty();
	const bool later = same && was && own->at != to.data_at;
	if (same && was == holds && !later) {
		// Unchanged data needs no memory.
		return;
	}
	data.reserve_for(id, !holds && !to.data.empty(), !to.data.empty(),
			r_reserved.new_ids != nullptr ? &r_reserved.new_ids->data : nullptr);
	if (same && !later) {
		return;
	}
	r_reserved.changes += later ? 0 : 1;
	layers.try_emplace(layer_of(id));
	if (!to.data.empty()) {
		r_reserved.data.emplace(
				id, std::make_shared<const Data>(Data{Bytes(to.data.begin(), to.data.end()), to.data_at}));
	}
}

void InstanceState::Content::plan_removed(std::uint64_t id, const Entry &to, ReservedMemory &r_reserved) {
	const bool was = removed.contains(id);
	const bool timed = to.removed && to.until > 0.0;
	r_reserved.due += timed ? 1 : 0;
	if (was != to.removed || (was && removed.value(id) != to.until)) {
		removed.reserve_for(id, !was, timed, r_reserved.new_ids != nullptr ? &r_reserved.new_ids->removed : nullptr);
	}
	if (was != to.removed) {
		++r_reserved.changes;
		layers.try_emplace(layer_of(id));
	}
}

/// Returns false if the current instance will be deleted along with its data. A moved instance
/// keeps its data.
bool InstanceState::Content::plan_added(std::uint64_t id, const Entry &to, ReservedMemory &r_reserved) {
	const Placed *own = added.value(id).get();
	const bool was = own != nullptr;
	const bool same = was ? to.instance != nullptr && *to.instance == own->instance : to.instance == nullptr;
	if (same && (!was || own->at == to.placed_at)) {
		return true;
	}
	added.reserve_for(id, !was, true, r_reserved.new_ids != nullptr ? &r_reserved.new_ids->added : nullptr);
	if (to.instance != nullptr) {
		r_reserved.added.emplace(id, std::make_shared<const Placed>(Placed{*to.instance, to.placed_at}));
	}
	if (same) {
		return true;
	}
	r_reserved.changes += was ? 1 : 0;
	if (to.instance != nullptr) {
		++r_reserved.changes;
		layers.try_emplace(to.instance->layer);
		r_reserved.grid.insert(id, square_position(*to.instance));
	}
	return !was || to.instance != nullptr;
}

void InstanceState::Content::reserve(const ReservedMemory &reserved, std::vector<InstanceChange> &r_changes) {
	reserve_more(due, reserved.due);
	reserve_more(r_changes, reserved.changes);
}

void InstanceState::Content::change(std::uint64_t id, const Entry &to, ReservedMemory &r_reserved,
		std::vector<InstanceChange> &r_changes) noexcept {
	if (is_added(id)) {
		change_added(id, to, r_reserved, r_changes);
	} else {
		change_removed(id, to, r_changes);
	}
	change_data(id, to, r_reserved, r_changes);
}

void InstanceState::Content::change_removed(std::uint64_t id, const Entry &to, std::vector<InstanceChange> &r_changes) {
	const bool was = removed.contains(id);
	if (to.removed && (!was || removed.value(id) != to.until)) {
		removed.insert(id, to.until);
		plan_return(id, to.until);
		record(id);
	} else if (!to.removed && was) {
		removed.erase(id);
		record(id);
	}
	if (was == to.removed) {
		return;
	}
	Layer &layer = layers[layer_of(id)];
	layer.removed += to.removed ? 1 : -std::size_t{1};
	r_changes.push_back({id, to.removed ? InstanceChangeKind::removed : InstanceChangeKind::restored, {}});
}

void InstanceState::Content::change_added(
		std::uint64_t id, const Entry &entry, ReservedMemory &r_reserved, std::vector<InstanceChange> &r_changes) {
	const AddedInstance *to = entry.instance;
	const Placed *own = added.value(id).get();
	const bool was = own != nullptr;
	if (was ? to != nullptr && *to == own->instance : to == nullptr) {
		if (was && own->at != entry.placed_at) {
			added.insert(id, std::move(r_reserved.added.find(id)->second));
			record(id);
		}
		return;
	}
	const bool moves = was && to != nullptr;
	if (was) {
		r_changes.push_back({id, moves ? InstanceChangeKind::left : InstanceChangeKind::removed, take_away(id)});
	}
	if (to != nullptr) {
		place(id, r_reserved);
		r_changes.push_back({id, moves ? InstanceChangeKind::moved : InstanceChangeKind::added, *to});
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
	const std::span<const std::uint8_t> to = entry.data;
	const Data *own = data.value(id).get();
	const bool was = own != nullptr;
	if (was ? std::ranges::equal(own->bytes, to) : to.empty()) {
		if (was && own->at != entry.data_at) {
			data.insert(id, std::move(r_reserved.data.find(id)->second));
			record(id);
		}
		return;
	}
	if (!is_added(id)) {
		layers[layer_of(id)].with_data += to.empty() ? -std::size_t{1} : std::size_t{was ? 0U : 1U};
	}
	if (to.empty()) {
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

void InstanceState::Content::move_clock(double to, std::vector<InstanceChange> &r_changes) {
	ReservedMemory nothing;
	std::size_t max_count = 0;
	for_each_due(to, [&](std::uint64_t id) {
		removed.reserve_for(id, false, false, nullptr);
		++max_count;
	});
	reserve_more(r_changes, max_count);
	time = to;
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
