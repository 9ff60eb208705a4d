#include "core/state/instance_state_content.hpp"

#include "core/base/guard.hpp"
#include "core/base/reserve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace thicket {

namespace {

/// The length of the longest column of the basis.
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
	entry.until = entry.removed ? removed.time(id) : 0.0;
	if (const auto own = added.find(id); own != added.end()) {
		entry.instance = &own->second;
	}
	if (const auto own = data.find(id); own != data.end()) {
		entry.data = own->second;
	}
	return entry;
}

StateChange InstanceState::Content::change_one(std::uint64_t id, const Entry &to, const char *asked_for, double value) {
	std::vector<InstanceChange> changes;
	const Status status =
			guarded(asked_for, value, [&] { change_all([&](const auto &use) { use(id, to); }, changes); });
	return {status, !changes.empty()};
}

InstanceState::Content::Room InstanceState::Content::empty_room() const {
	Room room;
	room.removed = room.most_removed = removed.size();
	return room;
}

/// Takes the memory for what `change` will do, except for what `make_room` takes for all together.
void InstanceState::Content::plan(std::uint64_t id, const Entry &to, Room &r_room) {
	bool data_stay = true;
	if (is_added(id)) {
		data_stay = plan_added(id, to.instance, r_room);
	} else {
		plan_removed(id, to, r_room);
	}
	const auto own = data.find(id);
	const bool was = data_stay && own != data.end();
	if (was ? std::ranges::equal(own->second, to.data) : to.data.empty()) {
		return;
	}
	++r_room.changes;
	layers.try_emplace(layer_of(id));
	if (!to.data.empty()) {
		r_room.data.emplace(id, Bytes(to.data.begin(), to.data.end()));
	}
}

void InstanceState::Content::plan_removed(std::uint64_t id, const Entry &to, Room &r_room) {
	const bool was = removed.contains(id);
	if (to.removed && to.until > 0.0) {
		++r_room.due;
		r_room.timed = true;
	}
	if (was != to.removed) {
		++r_room.changes;
		layers.try_emplace(layer_of(id));
		r_room.removed += to.removed ? 1 : -std::size_t{1};
		r_room.most_removed = std::max(r_room.most_removed, r_room.removed);
	}
}

/// False if the instance that is there will go, with its data. One that stays, elsewhere, keeps them.
bool InstanceState::Content::plan_added(std::uint64_t id, const AddedInstance *to, Room &r_room) {
	const auto own = added.find(id);
	const bool was = own != added.end();
	if (was ? to != nullptr && *to == own->second : to == nullptr) {
		return true;
	}
	r_room.changes += was ? 1 : 0;
	if (to != nullptr) {
		++r_room.changes;
		layers.try_emplace(to->layer);
		r_room.added.emplace(id, *to);
		r_room.grid.insert(id, square_position(*to));
	}
	return !was || to != nullptr;
}

void InstanceState::Content::make_room(const Room &room, std::vector<InstanceChange> &r_changes) {
	removed.reserve(room.most_removed + 1, room.timed); // One more: a new time for one that is in asks for that.
	reserve_more(due, room.due);
	reserve_more(r_changes, room.changes);
}

void InstanceState::Content::change(
		std::uint64_t id, const Entry &to, Room &r_room, std::vector<InstanceChange> &r_changes) noexcept {
	if (is_added(id)) {
		change_added(id, to.instance, r_room, r_changes);
	} else {
		change_removed(id, to, r_changes);
	}
	change_data(id, to.data, r_room, r_changes);
}

void InstanceState::Content::change_removed(std::uint64_t id, const Entry &to, std::vector<InstanceChange> &r_changes) {
	const bool was = removed.contains(id);
	if (to.removed && (!was || removed.time(id) != to.until)) {
		removed.insert(id, to.until);
		plan_return(id, to.until);
		note(id);
	} else if (!to.removed && was) {
		removed.erase(id);
		note(id);
	}
	if (was == to.removed) {
		return;
	}
	Layer &layer = layers[layer_of(id)];
	layer.removed += to.removed ? 1 : -std::size_t{1};
	r_changes.push_back({id, to.removed ? InstanceChangeKind::removed : InstanceChangeKind::restored, {}});
}

void InstanceState::Content::change_added(
		std::uint64_t id, const AddedInstance *to, Room &r_room, std::vector<InstanceChange> &r_changes) {
	const auto own = added.find(id);
	const bool was = own != added.end();
	if (was ? to != nullptr && *to == own->second : to == nullptr) {
		return;
	}
	const bool moves = was && to != nullptr;
	if (was) {
		r_changes.push_back({id, moves ? InstanceChangeKind::left : InstanceChangeKind::removed, take_away(id)});
	}
	if (to != nullptr) {
		place(id, r_room);
		r_changes.push_back({id, moves ? InstanceChangeKind::moved : InstanceChangeKind::added, *to});
	} else {
		data.erase(id);
	}
	note(id);
}

void InstanceState::Content::place(std::uint64_t id, Room &r_room) {
	const AddedInstance &instance = added.insert(r_room.added.extract(id)).position->second;
	Layer &layer = layers[instance.layer];
	layer.grid.take(r_room.grid, id, square_position(instance));
	layer.max_scale = std::max(layer.max_scale, scale_of(instance));
	++layer.added;
}

AddedInstance InstanceState::Content::take_away(std::uint64_t id) {
	const AddedInstance instance = added.extract(id).mapped();
	Layer &layer = layers[instance.layer];
	layer.grid.erase(id, square_position(instance));
	--layer.added;
	layer.max_scale = layer.added > 0 ? layer.max_scale : 0.0;
	return instance;
}

void InstanceState::Content::change_data(
		std::uint64_t id, std::span<const std::uint8_t> to, Room &r_room, std::vector<InstanceChange> &r_changes) {
	const auto own = data.find(id);
	const bool was = own != data.end();
	if (was ? std::ranges::equal(own->second, to) : to.empty()) {
		return;
	}
	if (was) {
		data.erase(own);
	}
	if (!to.empty()) {
		data.insert(r_room.data.extract(id));
	}
	if (!is_added(id)) {
		layers[layer_of(id)].with_data += to.empty() ? -std::size_t{1} : std::size_t{was ? 0U : 1U};
	}
	note(id);
	const auto placed = added.find(id);
	r_changes.push_back({id, InstanceChangeKind::data, placed != added.end() ? placed->second : AddedInstance()});
}

void InstanceState::Content::note(std::uint64_t id) {
	++revision;
	if (logging) {
		log.note(revision, id, size());
	}
}

void InstanceState::Content::plan_return(std::uint64_t id, double until) {
	if (until <= 0.0) {
		return;
	}
	constexpr std::size_t always_kept = 64;
	if (due.size() < 2 * removed.timed() + always_kept) {
		due.push_back({until, id});
		std::ranges::push_heap(due, std::greater<>());
		return;
	}
	due.clear(); // Most of it is out of date. What is left fits into the memory that it had.
	removed.for_each([this](std::uint64_t timed, double time) {
		if (time > 0.0) {
			due.push_back({time, timed});
		}
	});
	std::ranges::make_heap(due, std::greater<>());
}

Status InstanceState::Content::check_stamps(const StateRecord &record, bool replaced) const {
	for (const auto &[number, stamp] : record.stamps) {
		const auto own = layers.find(number);
		if (own == layers.end()) {
			continue;
		}
		const Layer &layer = own->second;
		const bool counts = record.holds_points(number) && (layer.claimed || (!replaced && layer.holds_points()));
		if (counts && stamp != 0 && layer.stamp != 0 && layer.stamp != stamp) {
			return {ErrorCode::foreign, "layer", static_cast<double>(number)};
		}
	}
	return {};
}

/// So that `take_stamps` takes no memory.
void InstanceState::Content::make_room_for_stamps(const StateRecord &record) {
	for (const auto &[number, stamp] : record.stamps) {
		layers.try_emplace(number);
	}
}

void InstanceState::Content::take_stamps(const StateRecord &record) {
	for (const auto &[number, stamp] : record.stamps) {
		Layer &layer = layers[number];
		const bool counts = record.holds_points(number) || layer.stamp == 0 || !(layer.claimed || layer.holds_points());
		if (stamp != 0 && counts) {
			layer.stamp = stamp;
		}
	}
}

std::vector<std::uint64_t> InstanceState::Content::all_ids() const {
	std::vector<std::uint64_t> ids;
	ids.reserve(size());
	removed.for_each([&ids](std::uint64_t id, double) { ids.push_back(id); });
	for (const auto &[id, instance] : added) {
		ids.push_back(id);
	}
	for (const auto &[id, bytes] : data) {
		if (!removed.contains(id) && !added.contains(id)) {
			ids.push_back(id);
		}
	}
	std::ranges::sort(ids);
	return ids;
}

void InstanceState::Content::add_to(StateRecord &r_record, std::uint64_t code) const {
	const std::uint64_t id = id_of(code);
	const Entry now = entry(id);
	if (now.removed) {
		if (now.until > 0.0) {
			r_record.until.emplace_back(r_record.removed.size(), now.until);
		}
		r_record.removed.push_back(code);
	} else if (now.instance != nullptr) {
		r_record.added.push_back(code);
		r_record.instances.push_back(*now.instance);
	} else {
		(is_added(id) ? r_record.gone : r_record.standing).push_back(code);
	}
	if (!now.data.empty()) {
		r_record.with_data.push_back(code);
		r_record.data.emplace_back(now.data.begin(), now.data.end());
	}
}

StateRecord InstanceState::Content::record_of(std::vector<std::uint64_t> ids, bool whole) const {
	for (std::uint64_t &id : ids) {
		id = code_of(id);
	}
	std::ranges::sort(ids);
	StateRecord record;
	record.whole = whole;
	record.time = time;
	for (const std::uint64_t code : ids) {
		add_to(record, code);
	}
	record.stamps = record.layers();
	for (auto &[number, stamp] : record.stamps) {
		if (const auto own = layers.find(number); own != layers.end()) {
			stamp = own->second.stamp;
		}
	}
	return record;
}

/// How many are due by a time, from one of the heap on: no child comes before its parent.
std::size_t InstanceState::Content::count_due(double until, std::size_t at) const {
	if (at >= due.size() || due[at].time > until) {
		return 0;
	}
	return 1 + count_due(until, 2 * at + 1) + count_due(until, 2 * at + 2);
}

void InstanceState::Content::move_clock(double to, std::vector<InstanceChange> &r_changes) {
	Room nothing;
	reserve_more(r_changes, count_due(to));
	time = to;
	while (!due.empty() && due.front().time <= time) {
		const Due first = due.front();
		std::ranges::pop_heap(due, std::greater<>());
		due.pop_back();
		if (removed.time(first.id) == first.time) {
			Entry entry = this->entry(first.id);
			entry.removed = false;
			change(first.id, entry, nothing, r_changes);
		}
	}
	removed.shrink();
}

void InstanceState::Content::follow(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	std::vector<std::uint64_t> unnamed;
	if (record.whole) {
		unnamed = all_ids();
		std::erase_if(unnamed, [&record](std::uint64_t id) { return record.names(id); });
	}
	make_room_for_stamps(record);
	const auto each = [&](const auto &use) {
		for (const std::uint64_t id : unnamed) {
			use(id, Entry{});
		}
		record.for_each(use);
	};
	change_all(each, r_changes);
	for (auto &[number, layer] : layers) {
		layer.stamp = !record.whole || layer.claimed ? layer.stamp : 0;
	}
	take_stamps(record);
}

void InstanceState::Content::start_from(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	logging = false;
	const Status status = guarded("changes", 0.0, [&] { follow(record, r_changes); });
	logging = true;
	throw_if_out_of_memory(status);
	time = record.time;
	log.start_at(++revision);
	std::erase_if(layers, [](const auto &layer) { return !layer.second.claimed && !layer.second.holds_any(); });
}

} // namespace thicket
