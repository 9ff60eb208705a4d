// This file exchanges content between an InstanceState and other states.

#include "core/state/instance_state_content.hpp"

#include "core/base/bytes.hpp"
#include "core/base/guard.hpp"
#include "core/state/state_format.hpp"

#include <algorithm>

namespace thicket {

Status InstanceState::save(std::vector<std::uint8_t> &r_bytes) const {
	return guarded_answer("state", static_cast<double>(content_->size()), r_bytes,
			[&] { write(content_->complete_record(), r_bytes); });
}

Status InstanceState::load(std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes) {
	StateRecord record;
	if (const Status status = read(bytes, record); !status.ok()) {
		return status;
	}
	if (!record.is_complete) {
		return {ErrorCode::corrupt, "data"};
	}
	if (const Status status = content_->check_stamps(record, true); !status.ok()) {
		return status;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&] { content_->start_from(record, r_changes); });
}

Status InstanceState::diff_since(std::uint64_t revision, std::vector<std::uint8_t> &r_bytes, bool ordered) const {
	const bool known = revision <= content_->revision && content_->log.knows(revision);
	return guarded_answer("state", static_cast<double>(content_->size()), r_bytes, [&] {
		StateRecord record =
				known ? content_->record_of(content_->log.since(revision), false) : content_->complete_record();
		if (ordered && content_->origin != 0) {
			record.origin = {content_->origin, known ? revision : 0, content_->revision};
		}
		write(record, r_bytes);
	});
}

Status InstanceState::diff_of(std::span<const std::uint64_t> ids, std::vector<std::uint8_t> &r_bytes) const {
	return guarded_answer("ids", static_cast<double>(ids.size()), r_bytes, [&] {
		std::vector<std::uint64_t> once(ids.begin(), ids.end());
		std::ranges::sort(once);
		once.erase(std::unique(once.begin(), once.end()), once.end());
		std::erase(once, IdTable<double>::none);
		write(content_->record_of(std::move(once), false), r_bytes);
	});
}

Status InstanceState::apply(
		std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits) {
	StateRecord record;
	if (const Status status = read(bytes, record, limits, content_->cancel); !status.ok()) {
		return status;
	}
	const StateOrigin &origin = record.origin;
	const std::uint64_t known = content_->known.of(origin.name);
	if (origin.name != 0 && (origin.end < known || (origin.end == known && origin.base < known))) {
		return {}; // The diff is late or repeated.
	}
	if (origin.name != 0 && origin.base > known) {
		return thicket::missing_before(origin.base, known);
	}
	if (const Status status = content_->check_stamps(record, record.is_complete); !status.ok()) {
		return status;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&]() -> Status {
		content_->known.reserve_entry();
		if (const Status status = content_->follow(record, limits, r_changes); !status.ok()) {
			return status;
		}
		if (record.is_complete) {
			content_->time = record.time;
			content_->known.clear();
		} else {
			const double latest = content_->time + std::max(limits.max_clock_advance, 0.0);
			content_->time = std::max(content_->time, std::min(record.time, latest));
		}
		if (origin.name != 0) {
			content_->known.set(origin.name, origin.end);
		}
		return {};
	});
}

Status InstanceState::missing_before(
		std::span<const std::uint8_t> bytes, bool &r_missing, std::uint64_t &r_since) const {
	StateHeader header;
	const Status status = read_header(bytes, header);
	if (status.ok()) {
		r_since = content_->known.of(header.origin.name);
		r_missing = header.origin.name != 0 && header.origin.base > r_since;
	}
	return status;
}

std::uint64_t InstanceState::digest() const {
	StateRecord record = content_->complete_record();
	record.time = 0.0;
	for (auto &[layer, stamp] : record.stamps) {
		stamp = 0;
	}
	std::vector<std::uint8_t> bytes;
	write(record, bytes, nullptr, former_state_format);
	return checksum(bytes);
}

Status InstanceState::Content::check_stamps(const StateRecord &record, bool replaced) const {
	for (const auto &[number, stamp] : record.stamps) {
		const auto layer_entry = layers.find(number);
		if (layer_entry == layers.end()) {
			continue;
		}
		const Layer &layer = layer_entry->second;
		const bool counts = record.has_points(number) && (layer.claimed || (!replaced && layer.has_points()));
		if (counts && stamp != 0 && layer.stamp != 0 && layer.stamp != stamp) {
			return {ErrorCode::foreign, "layer", static_cast<double>(number)};
		}
	}
	return {};
}

/// Creates the layers that `take_stamps` needs, so that it allocates no memory.
void InstanceState::Content::reserve_stamps(const StateRecord &record) {
	for (const auto &[number, stamp] : record.stamps) {
		layers.try_emplace(number);
	}
}

void InstanceState::Content::take_stamps(const StateRecord &record) {
	for (const auto &[number, stamp] : record.stamps) {
		Layer &layer = layers[number];
		const bool counts = record.has_points(number) || layer.stamp == 0 || !(layer.claimed || layer.has_points());
		if (stamp != 0 && counts) {
			layer.stamp = stamp;
		}
	}
}

std::vector<std::uint64_t> InstanceState::Content::all_ids() const {
	std::vector<std::uint64_t> ids;
	ids.reserve(size());
	removed.for_each([&ids](std::uint64_t id, double) { ids.push_back(id); });
	added.for_each([&ids](std::uint64_t id, const SharedInstance &) { ids.push_back(id); });
	data.for_each([&](std::uint64_t id, const SharedData &) {
		if (!removed.contains(id) && !added.contains(id)) {
			ids.push_back(id);
		}
	});
	std::ranges::sort(ids);
	return ids;
}

void InstanceState::Content::add_to(StateRecord &r_record, std::uint64_t code) const {
	const std::uint64_t id = id_of(code);
	const Entry current = entry(id);
	if (current.removed) {
		if (current.until > 0.0) {
			r_record.until.emplace_back(r_record.removed.size(), current.until);
		}
		r_record.removed.push_back(code);
	} else if (current.instance != nullptr) {
		r_record.added.push_back(code);
		r_record.instances.push_back(*current.instance);
		r_record.placed_at.push_back(current.placed_at);
	} else {
		(is_added(id) ? r_record.removed_placed : r_record.present).push_back(code);
	}
	if (!current.data.empty()) {
		r_record.with_data.push_back(code);
		r_record.data.emplace_back(current.data.begin(), current.data.end());
		r_record.data_at.push_back(current.data_at);
	}
}

StateRecord InstanceState::Content::record_of(std::vector<std::uint64_t> ids, bool is_complete) const {
	for (std::uint64_t &id : ids) {
		id = code_of(id);
	}
	std::ranges::sort(ids);
	StateRecord record;
	record.is_complete = is_complete;
	record.time = time;
	for (const std::uint64_t code : ids) {
		add_to(record, code);
	}
	record.stamps = record.layers();
	for (auto &[number, stamp] : record.stamps) {
		if (const auto layer_entry = layers.find(number); layer_entry != layers.end()) {
			stamp = layer_entry->second.stamp;
		}
	}
	return record;
}

Status InstanceState::Content::follow(
		const StateRecord &record, const DiffLimits &limits, std::vector<InstanceChange> &r_changes) {
	std::vector<std::uint64_t> unnamed;
	if (record.is_complete) {
		unnamed = all_ids();
		std::erase_if(unnamed, [&record](std::uint64_t id) { return record.contains(id); });
	}
	const auto visit_entries = [&](const auto &use) {
		for (const std::uint64_t id : unnamed) {
			use(id, Entry{});
		}
		record.for_each(use);
	};
	if (const Status status = check_changes(record, visit_entries, limits); !status.ok()) {
		return status;
	}
	reserve_stamps(record);
	if (record.removed.size() > removed.size()) {
		// Grows the table only once, not several times while IDs are inserted.
		removed.expect(record.removed.size() - removed.size());
	}
	change_all(visit_entries, r_changes);
	for (auto &[number, layer] : layers) {
		layer.stamp = !record.is_complete || layer.claimed ? layer.stamp : 0;
	}
	take_stamps(record);
	return {};
}

void InstanceState::Content::start_from(const StateRecord &record, std::vector<InstanceChange> &r_changes) {
	logging = false;
	const Status status = guarded("changes", 0.0, [&] { return follow(record, DiffLimits::none(), r_changes); });
	logging = true;
	throw_if_out_of_memory(status);
	time = record.time;
	known.clear();
	log.start_at(++revision);
	std::erase_if(layers, [](const auto &layer) { return !layer.second.claimed && !layer.second.has_entries(); });
}

} // namespace thicket
