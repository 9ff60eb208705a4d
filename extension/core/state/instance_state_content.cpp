#include "core/state/instance_state_content.hpp"

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

void InstanceState::Content::change(std::uint64_t id, const Entry &to, std::vector<InstanceChange> &r_changes) {
	if (is_added(id)) {
		change_added(id, to.instance, r_changes);
	} else {
		change_removed(id, to, r_changes);
	}
	change_data(id, to.data, r_changes);
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
		std::uint64_t id, const AddedInstance *to, std::vector<InstanceChange> &r_changes) {
	const auto own = added.find(id);
	const bool was = own != added.end();
	if (was ? to != nullptr && *to == own->second : to == nullptr) {
		return;
	}
	if (was) {
		r_changes.push_back({id, InstanceChangeKind::removed, take_away(id)});
	}
	if (to != nullptr) {
		place(id, *to);
		r_changes.push_back({id, InstanceChangeKind::added, *to});
	}
	note(id);
}

void InstanceState::Content::place(std::uint64_t id, const AddedInstance &instance) {
	Layer &layer = layers[instance.layer];
	added.emplace(id, instance);
	layer.grid.insert(id, {instance.position.x, instance.position.z});
	layer.max_scale = std::max(layer.max_scale, scale_of(instance));
	++layer.added;
}

AddedInstance InstanceState::Content::take_away(std::uint64_t id) {
	const AddedInstance instance = added.extract(id).mapped();
	Layer &layer = layers[instance.layer];
	layer.grid.erase(id, {instance.position.x, instance.position.z});
	--layer.added;
	layer.max_scale = layer.added > 0 ? layer.max_scale : 0.0;
	layer.with_data -= data.erase(id);
	return instance;
}

void InstanceState::Content::change_data(
		std::uint64_t id, std::span<const std::uint8_t> to, std::vector<InstanceChange> &r_changes) {
	const auto own = data.find(id);
	const bool was = own != data.end();
	if (was ? std::ranges::equal(own->second, to) : to.empty()) {
		return;
	}
	Layer &layer = layers[layer_of(id)];
	if (to.empty()) {
		data.erase(own);
		--layer.with_data;
	} else {
		data[id] = Bytes(to.begin(), to.end());
		layer.with_data += was ? 0 : 1;
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
	due.clear(); // Most of it is out of date.
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
		const bool counts = layer.claimed || (!replaced && layer.holds_any());
		if (counts && stamp != 0 && layer.stamp != 0 && layer.stamp != stamp) {
			return {ErrorCode::foreign, "layer", static_cast<double>(number)};
		}
	}
	return {};
}

void InstanceState::Content::take_stamps(const StateRecord &record) {
	for (const auto &[number, stamp] : record.stamps) {
		if (stamp != 0) {
			layers[number].stamp = stamp;
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

void InstanceState::Content::follow(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	if (record.whole) {
		for (const std::uint64_t id : all_ids()) {
			if (!record.names(id)) {
				change(id, {}, r_changes);
			}
		}
		for (auto &[number, layer] : layers) {
			layer.stamp = layer.claimed ? layer.stamp : 0;
		}
	}
	record.for_each([this, &r_changes](std::uint64_t id, const Entry &entry) { change(id, entry, r_changes); });
	take_stamps(record);
}

void InstanceState::Content::start_from(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	logging = false;
	follow(record, r_changes);
	logging = true;
	time = record.time;
	log.start_at(++revision);
	std::erase_if(layers, [](const auto &layer) { return !layer.second.claimed && !layer.second.holds_any(); });
}

} // namespace thicket
