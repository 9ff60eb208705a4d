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
	Entry both = entry(id);
	if (theirs.removed) {
		const bool forever = theirs.until == 0.0 || (both.removed && both.until == 0.0);
		both.until = forever ? 0.0 : std::max(both.until, theirs.until);
		both.removed = true;
	}
	if (both.removed && both.until > 0.0 && both.until <= clock) {
		both.removed = false;
		both.until = 0.0;
	}
	if (theirs.instance != nullptr) {
		const bool later = both.instance == nullptr || both.placed_at < theirs.placed_at ||
				(both.placed_at == theirs.placed_at && is_less(*both.instance, *theirs.instance));
		both.placed_at = later ? theirs.placed_at : both.placed_at;
		both.instance = later ? theirs.instance : both.instance;
	}
	const bool later = both.data.empty() || both.data_at < theirs.data_at ||
			(both.data_at == theirs.data_at && std::ranges::lexicographical_compare(both.data, theirs.data));
	if (!theirs.data.empty() && later) {
		both.data = theirs.data;
		both.data_at = theirs.data_at;
	}
	return both;
}

Status InstanceState::Content::take_in(
		const StateRecord &record, double clock, const DiffLimits &limits, std::vector<InstanceChange> &r_changes) {
	if (const Status status = check_stamps(record, false); !status.ok()) {
		return status;
	}
	const double latest = std::max(time, clock);
	std::vector<std::uint64_t> grown;
	for_each_due(latest, [&](std::uint64_t id) {
		const double until = removed.value(id);
		if (until > 0.0 && until <= latest && !record.contains(id)) {
			grown.push_back(id);
		}
	});
	std::ranges::sort(grown);
	grown.erase(std::unique(grown.begin(), grown.end()), grown.end()); // The heap may contain an ID twice.
	const auto each = [&](const auto &use) {
		for (const std::uint64_t id : grown) {
			Entry to = entry(id);
			to.removed = false;
			to.until = 0.0;
			use(id, to);
		}
		record.for_each([&](std::uint64_t id, const Entry &theirs) { use(id, joined(id, theirs, latest)); });
	};
	if (const Status status = check_changes(record, each, limits); !status.ok()) {
		return status;
	}
	reserve_stamps(record);
	change_all(each, r_changes);
	take_stamps(record);
	time = latest;
	return {};
}

Status InstanceState::Content::check_place(std::uint64_t id, const Entry &to, const DiffLimits &limits) const {
	const auto at = [](const AddedInstance &instance) {
		const glm::dvec2 position(instance.position.x, instance.position.z);
		return Rect{position, position};
	};
	if (!is_added(id)) {
		Rect cell;
		return find_cell(id, cell) ? check_area(limits, cell) : unknown_cells(layer_of(id));
	}
	Status status;
	for (const AddedInstance *instance : {instance_of(id), to.instance}) {
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
	const auto own = layers.find(layer_of(id));
	if (own == layers.end() || own->second.cell_side <= 0.0) {
		return false;
	}
	const double side = own->second.cell_side;
	const glm::ivec2 first = unpack(id).cell & ~(own->second.cells_together - 1);
	r_cell = {glm::dvec2(first) * side, glm::dvec2(first + own->second.cells_together) * side};
	return true;
}

} // namespace thicket
