// This file contains the part of NearQueue that returns held instances to be rebuilt, nearest
// first, a few at a time. Lists are built for one cell at a time, because a frame has no time for
// all held instances.

#include "core/near/near_queue.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

namespace thicket {

/// Returns the centers whose reach includes a cell. Until these are determined, all centers are
/// returned.
std::span<const glm::dvec3> NearQueue::centers_of(const NearCell &cell) const {
	return cell.centers().empty() ? std::span(centers_) : cell.centers();
}

void NearQueue::renew(std::uint32_t layer) {
	std::erase_if(due_cells_, [layer](const Renewal &renewal) { return renewal.layer == layer; });
	for (const auto &[key, cell] : layers_[layer].cells) {
		if (!cell.holds_nothing()) {
			const double away = squared_cell_distance(layers_[layer].rect(key), centers_of(cell));
			due_cells_.push_back({away, layer, key, false, {}});
		}
	}
	std::ranges::make_heap(due_cells_, farther);
}

/// Restarts the renewal of a layer whose cells were divided differently, because the instances of
/// one cell may now lie in several cells.
void NearQueue::renew_divided(std::uint32_t layer) {
	if (std::ranges::any_of(due_cells_, [layer](const Renewal &renewal) { return renewal.layer == layer; })) {
		renew(layer);
	}
}

/// Lists the held instances of a cell. Returns false if the cell no longer holds any.
bool NearQueue::list_due(Renewal &r_renewal) const {
	const auto &cells = layers_[r_renewal.layer].cells;
	const auto found = cells.find(r_renewal.key);
	if (found == cells.end() || found->second.holds_nothing()) {
		return false;
	}
	const std::span<const glm::dvec3> centers = centers_of(found->second);
	for (const PlacedInstance &instance : found->second.held()) {
		r_renewal.due.emplace_back(squared_distance(instance.position, centers), instance);
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

std::vector<NearHeld> NearQueue::held_within(
		std::span<const glm::dvec3> positions, double reach, std::size_t max_count) const {
	std::vector<NearHeld> found;
	for (std::uint32_t index = 0; index < layers_.size(); ++index) {
		for (const auto &[key, cell] : layers_[index].cells) {
			if (squared_cell_distance(layers_[index].rect(key), positions) > reach * reach) {
				continue;
			}
			cell.for_each_position([&](std::uint64_t id, glm::dvec3 position) {
				const double away = squared_distance(position, positions);
				if (away <= reach * reach) {
					found.push_back({away, index, id});
				}
			});
		}
	}
	const auto count = std::min(found.size(), max_count);
	std::ranges::partial_sort(found, found.begin() + static_cast<std::ptrdiff_t>(count), {},
			[](const NearHeld &each) { return std::tuple(each.distance_squared, each.id, each.layer); });
	found.resize(count);
	return found;
}

} // namespace thicket
