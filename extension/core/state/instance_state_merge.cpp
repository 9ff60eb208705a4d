// This file merges states without an authority and checks changes from other states against limits.

#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/state/instance_state_content.hpp"
#include "core/state/state_format.hpp"

#include <algorithm>
#include <vector>

namespace thicket {

Status InstanceState::merge(const InstanceState &other, std::vector<InstanceChange> &r_changes) {
	return guarded("other", static_cast<double>(other.content_->size()), [&] {
		const StateRecord record = other.content_->complete_record();
		return content_->take_in(record, record.time, DiffLimits::none(), r_changes);
	});
}

Status InstanceState::merge_diff(
		std::span<const std::uint8_t> bytes, std::vector<InstanceChange> &r_changes, const DiffLimits &limits) {
	DiffLimits joining = limits;
	joining.allow_replacement = true; // Merging replaces nothing, so this limit does not apply.
	StateRecord record;
	if (const Status status = read(bytes, record, joining, content_->cancel); !status.ok()) {
		return status;
	}
	return guarded("data", static_cast<double>(bytes.size()), [&] {
		const double latest = content_->time + std::max(limits.max_clock_advance, 0.0);
		return content_->take_in(record, std::min(record.time, latest), joining, r_changes);
	});
}

/// Merges the current content of an ID with its content in the other state. Each part of the result
/// is the maximum of both parts in a total order, so that the order of merges does not matter.
StateRecord::Entry InstanceState::Content::joined(std::uint64_t id, const Entry &theirs, double clock) const {
	Entry merged = entry(id);
	if (theirs.removed) {
		const bool forever = theirs.until == 0.0 || (merged.removed && merged.until == 0.0);
		merged.until = forever ? 0.0 : std::max(merged.until, theirs.until);
		merged.removed = true;
	}
	if (merged.removed && merged.until > 0.0 && merged.until <= clock) {
		merged.removed = false;
		merged.until = 0.0;
	}
	if (theirs.instance != nullptr) {
		const bool is_later = merged.instance == nullptr || merged.placed_at < theirs.placed_at ||
				(merged.placed_at == theirs.placed_at && is_less(*merged.instance, *theirs.instance));
		merged.placed_at = is_later ? theirs.placed_at : merged.placed_at;
		merged.instance = is_later ? theirs.instance : merged.instance;
	}
	const bool is_later = merged.data.empty() || merged.data_at < theirs.data_at ||
			(merged.data_at == theirs.data_at && std::ranges::lexicographical_compare(merged.data, theirs.data));
	if (!theirs.data.empty() && is_later) {
		merged.data = theirs.data;
		merged.data_at = theirs.data_at;
	}
	return merged;
}

Status InstanceState::Content::take_in(
		const StateRecord &record, double clock, const DiffLimits &limits, std::vector<InstanceChange> &r_changes) {
	if (const Status status = check_stamps(record, false); !status.ok()) {
		return status;
	}
	const double latest = std::max(time, clock);
	std::vector<std::uint64_t> due_ids;
	for_each_due(latest, [&](std::uint64_t id) {
		const double until = removed.value(id);
		if (until > 0.0 && until <= latest && !record.contains(id)) {
			due_ids.push_back(id);
		}
	});
	std::ranges::sort(due_ids);
	due_ids.erase(std::unique(due_ids.begin(), due_ids.end()), due_ids.end()); // The heap may contain an ID twice.
	const auto visit_entries = [&](const auto &use) {
		for (const std::uint64_t id : due_ids) {
			Entry target = entry(id);
			target.removed = false;
			target.until = 0.0;
			use(id, target);
		}
		record.for_each([&](std::uint64_t id, const Entry &theirs) { use(id, joined(id, theirs, latest)); });
	};
	if (const Status status = check_changes(record, visit_entries, limits); !status.ok()) {
		return status;
	}
	reserve_stamps(record);
	change_all(visit_entries, r_changes);
	take_stamps(record);
	time = latest;
	return {};
}

Status InstanceState::Content::check_place(std::uint64_t id, const Entry &target, const DiffLimits &limits) const {
	const auto at = [](const AddedInstance &instance) {
		const glm::dvec2 position(instance.position.x, instance.position.z);
		return Rect{position, position};
	};
	if (!is_added(id)) {
		Rect cell;
		return find_cell(id, cell) ? check_area(limits, cell) : unknown_cells(layer_of(id));
	}
	Status status;
	for (const AddedInstance *instance : {instance_of(id), target.instance}) {
		if (status.ok() && instance != nullptr) {
			status = check_area(limits, at(*instance));
		}
	}
	return status;
}

Status InstanceState::Content::check_held(std::size_t held, std::size_t placed, const DiffLimits &limits) const {
	// If the state already exceeds a limit, only an increase is an error.
	Status status;
	if (held > size()) {
		status = check_limit("total changes", held, limits.max_total_changes, "max_total_changes of diff_limits");
	}
	if (status.ok() && placed > added.size()) {
		status = check_limit("hand-placed instances", placed, limits.max_added, "max_added of diff_limits");
	}
	return status;
}

bool InstanceState::Content::find_cell(std::uint64_t id, Rect &r_cell) const {
	const auto layer_entry = layers.find(layer_of(id));
	if (layer_entry == layers.end() || layer_entry->second.cell_side <= 0.0) {
		return false;
	}
	const double side = layer_entry->second.cell_side;
	const glm::ivec2 first = unpack(id).cell & ~(layer_entry->second.cells_together - 1);
	r_cell = {glm::dvec2(first) * side, glm::dvec2(first + layer_entry->second.cells_together) * side};
	return true;
}

} // namespace thicket
