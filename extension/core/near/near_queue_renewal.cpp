// The held instances of a NearQueue that must be rebuilt: nearest first, a few at a time. Lists are built for one cell at a time,
// because no frame has time for all held instances.

#include "core/near/near_queue.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

/// The centers that have a cell in reach; all centers until the next check has determined them.
std::span<const glm::dvec3> NearQueue::centers_of(const NearCell &cell) const {
	return cell.centers().empty() ? std::span(centers_) : cell.centers();
}

void NearQueue::renew(std::uint32_t layer) {
	std::erase_if(due_cells_, [layer](const Renewal &renewal) { return renewal.layer == layer; });
	for (const auto &[key, cell] : layers_[layer].cells) {
		if (!cell.holds_nothing()) {
			const double away = squared_to_cell(layers_[layer].rect(key), centers_of(cell));
			due_cells_.push_back({away, layer, key, false, {}});
		}
	}
	std::ranges::make_heap(due_cells_, farther);
}

/// Instances that were due in one cell may now lie in several cells.
void NearQueue::renew_divided(std::uint32_t layer) {
	if (std::ranges::any_of(due_cells_, [layer](const Renewal &renewal) { return renewal.layer == layer; })) {
		renew(layer);
	}
}

/// False if nothing of the cell is held any more.
bool NearQueue::list_due(Renewal &r_renewal) const {
	const auto &cells = layers_[r_renewal.layer].cells;
	const auto found = cells.find(r_renewal.key);
	if (found == cells.end() || found->second.holds_nothing()) {
		return false;
	}
	const std::span<const glm::dvec3> centers = centers_of(found->second);
	for (const PlacedInstance &instance : found->second.held()) {
		r_renewal.due.emplace_back(squared_to(instance.position, centers), instance);
	}
	std::ranges::sort(r_renewal.due, std::ranges::greater{},
			[](const auto &entry) { return std::pair(entry.first, entry.second.id); });
	r_renewal.listed = true;
	return true;
}

bool NearQueue::next_due(PlacedInstance &r_instance) {
	while (!due_cells_.empty()) {
		std::ranges::pop_heap(due_cells_, farther);
		Renewal &nearest = due_cells_.back();
		const bool found = nearest.listed;
		if (found) {
			r_instance = nearest.due.back().second;
			nearest.due.pop_back();
		}
		const bool more = found ? !nearest.due.empty() : list_due(nearest);
		if (more) {
			nearest.away = nearest.due.back().first;
			std::ranges::push_heap(due_cells_, farther);
		} else {
			due_cells_.pop_back();
		}
		if (found) {
			return true;
		}
	}
	return false;
}

std::vector<PlacedInstance> NearQueue::held_within(
		std::span<const glm::dvec3> positions, double reach, std::size_t most) const {
	std::vector<std::pair<double, PlacedInstance>> found;
	for (const Layer &layer : layers_) {
		for (const auto &[key, cell] : layer.cells) {
			if (squared_to_cell(layer.rect(key), positions) > reach * reach) {
				continue;
			}
			for (const PlacedInstance &instance : cell.held()) {
				const double away = squared_to(instance.position, positions);
				if (away <= reach * reach) {
					found.emplace_back(away, instance);
				}
			}
		}
	}
	std::ranges::sort(found, {}, [](const auto &entry) { return std::pair(entry.first, entry.second.id); });
	std::vector<PlacedInstance> result;
	for (const auto &[away, instance] : found) {
		if (result.size() < most) {
			result.push_back(instance);
		}
	}
	return result;
}

} // namespace thicket
