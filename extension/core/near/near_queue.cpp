#include "core/near/near_queue.hpp"

#include "core/base/guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <new>

namespace thicket {

namespace {

/// Minimum edge length of a cell in meters. Smaller cells would be numerous and nearly empty.
constexpr double min_side = 4.0;

/// Returns false for a center at which no instance can be placed: NAN, or too far from the origin.
bool possible(glm::dvec3 center) { return std::abs(center.x) < 1e12 && std::abs(center.z) < 1e12; }

} // namespace

NearQueue::Key NearQueue::Layer::key(glm::dvec3 position) const {
	return {static_cast<std::int64_t>(std::floor(position.x / side)),
			static_cast<std::int64_t>(std::floor(position.z / side))};
}

Rect NearQueue::Layer::rect(const Key &key) const {
	const glm::dvec2 corner = side * glm::dvec2(key.first, key.second);
	return {corner, corner + side};
}

/// Changes the size of the cells. Held instances stay held. Returns false, with the cells
/// unchanged, if memory runs out.
bool NearQueue::Layer::divide(double new_side) {
	Layer next;
	next.side = new_side;
	const Status status = guarded("distance", new_side, [&] {
		for (const auto &[from, cell] : cells) {
			for (const PlacedInstance &instance : cell.held()) {
				if (!next.cells[next.key(instance.position)].retain(instance)) {
					throw std::bad_alloc();
				}
			}
		}
	});
	if (status.ok()) {
		side = new_side;
		cells = std::move(next.cells);
	}
	return status.ok();
}

/// Updates the centers of each cell. Cells that hold nothing and are within reach of no center are
/// removed.
void NearQueue::Layer::find_cells(std::span<const glm::dvec3> new_centers) {
	stale = true; // Stays true if memory runs out.
	for (auto &[at, cell] : cells) {
		cell.forget_centers();
	}
	if (distance == 0.0) {
		std::erase_if(cells, [](const auto &entry) { return entry.second.holds_nothing(); });
	}
	const glm::dvec3 reach(leave_factor * distance);
	for (const glm::dvec3 &center : new_centers) {
		if (!possible(center)) {
			continue;
		}
		if (distance == 0.0) { // The layer is disabled: all held instances leave, nearest first.
			for (auto &[at, cell] : cells) {
				cell.add_center(center);
			}
			continue;
		}
		const Key first = key(center - reach);
		const Key last = key(center + reach);
		for (std::int64_t x = first.first; x <= last.first; ++x) {
			for (std::int64_t z = first.second; z <= last.second; ++z) {
				cells[{x, z}].add_center(center);
			}
		}
	}
	std::erase_if(cells, [](const auto &entry) { return entry.second.idle(); });
	centers.assign(new_centers.begin(), new_centers.end());
	stale = false;
}

void NearQueue::set_distances(std::span<const double> distances) {
	ready_.clear();
	layers_.resize(distances.size());
	for (std::size_t i = 0; i < distances.size(); ++i) {
		Layer &layer = layers_[i];
		if (layer.distance == distances[i]) {
			// If the distance is unchanged, the cells and their results stay valid.
			continue;
		}
		++changes_;
		layer.distance = distances[i];
		layer.stale = true;
		if (layer.distance > 0.0) {
			layer.divide(std::max(min_side, leave_factor * layer.distance / cells_in_reach));
			renew_divided(static_cast<std::uint32_t>(i));
		}
	}
}

void NearQueue::find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	world_ = &world;
	centers_.assign(centers.begin(), centers.end());
	ready_.clear();
	outdated_.clear();
	busy_.clear();
	checked_instances_ = 0;
	for (std::uint32_t index = 0; index < layers_.size(); ++index) {
		Layer &layer = layers_[index];
		if (layer.stale || !same_within(layer.slack(), centers, layer.centers)) {
			layer.find_cells(centers);
		}
		find_outdated(index);
	}
	check_nearest();
	for (std::uint32_t index = 0; index < layers_.size(); ++index) {
		for (auto &[key, cell] : layers_[index].cells) {
			if (cell.fresh(version()) && cell.any_change()) {
				ready_.push_back({index, key, &cell, false, {}});
			}
		}
	}
}

void NearQueue::check_nearest() {
	std::ranges::stable_sort(outdated_, {}, &Visit::order);
	for (const Visit &visit : outdated_) {
		const auto &[due, in_time, priority] = visit.order;
		std::size_t nearer = 0;
		for (const auto &[away, changes] : busy_) {
			nearer += !in_time || away > priority ? 0 : changes;
		}
		if (checked_instances_ >= max_checked_instances || nearer >= max_nearer_changes) {
			return;
		}
		check(visit);
		busy_.emplace_back(in_time ? priority : 0.0, visit.cell->change_count());
	}
}

void NearQueue::find_outdated(std::uint32_t index) {
	Layer &layer = layers_[index];
	for (auto &[key, cell] : layer.cells) {
		cell.begin_frame();
		cell.follow(index, layer.rect(key), *world_, version());
		const bool outdated = cell.outdated(layer.slack(), version());
		const double away =
				outdated || cell.any_change() ? squared_cell_distance(layer.rect(key), centers_of(cell)) : 0.0;
		if (!outdated && cell.any_change()) {
			busy_.emplace_back(away, cell.change_count());
		}
		if (!outdated && !cell.due()) {
			// The result of the last check is still valid.
			continue;
		}
		const bool late = cell.frames() > max_waiting_frames;
		const double priority = late ? static_cast<double>(cell.last_check) : away;
		outdated_.push_back({index, key, &cell, !outdated, {!outdated, !late, priority}});
	}
}

void NearQueue::check(const Visit &visit) {
	const Layer &layer = layers_[visit.layer];
	const NearRange range{enter_factor * layer.distance, leave_factor * layer.distance};
	checked_instances_ += visit.cell->check(visit.layer, layer.rect(visit.key), range, *world_, version(), present_);
	visit.cell->last_check = ++check_count_;
}

namespace {

/// Returns the visit with the smallest `away`, among the visits to cells for which `any` returns
/// true, or null if there is none.
template <class Visit>
const Visit *nearest_of(
		const std::vector<Visit> &visits, bool (NearCell::*any)() const, double (NearCell::*away)() const) {
	const Visit *nearest = nullptr;
	for (const Visit &visit : visits) {
		if ((visit.cell->*any)() && (nearest == nullptr || (visit.cell->*away)() < (nearest->cell->*away)())) {
			nearest = &visit;
		}
	}
	return nearest;
}

template <class Visit>
const Visit *first_of(const std::vector<Visit> &visits, bool (NearCell::*any)() const) {
	const auto found = std::ranges::find_if(visits, [any](const Visit &visit) { return (visit.cell->*any)(); });
	return found != visits.end() ? &*found : nullptr;
}

template <class Visit>
bool take_leaving(const Visit *visit, InstanceToRelease &r_leaving) {
	if (visit != nullptr) {
		const NearRelease leaving = visit->cell->take_leaving();
		r_leaving = {visit->layer, leaving.id, leaving.position};
	}
	return visit != nullptr;
}

} // namespace

bool NearQueue::next_removed(InstanceToRelease &r_leaving) {
	return take_leaving(nearest_of(ready_, &NearCell::any_removed, &NearCell::leaving_distance_squared), r_leaving);
}

bool NearQueue::next_leaving(InstanceToRelease &r_leaving) {
	return take_leaving(first_of(ready_, &NearCell::any_leaving), r_leaving);
}

bool NearQueue::next_changed(PlacedInstance &r_instance) {
	const Visit *visit = first_of(ready_, &NearCell::any_changed);
	if (visit != nullptr) {
		r_instance = visit->cell->take_changed();
	}
	return visit != nullptr;
}

bool NearQueue::next_entering(PlacedInstance &r_instance) {
	const Visit *visit = nearest_of(ready_, &NearCell::any_entering, &NearCell::entering_distance_squared);
	if (visit != nullptr) {
		r_instance = visit->cell->take_entering();
	}
	return visit != nullptr;
}

bool NearQueue::settled() const {
	return due_cells_.empty() && std::ranges::none_of(layers_, [this](const Layer &layer) {
		const bool wanted = layer.distance > 0.0 || !layer.cells.empty();
		return wanted &&
				(world_ == nullptr || layer.stale || std::ranges::any_of(layer.cells, [this](const auto &entry) {
					return !entry.second.settled(version());
				}));
	});
}

bool NearQueue::follows(std::span<const glm::dvec3> centers) const {
	return std::ranges::all_of(layers_, [centers](const Layer &layer) {
		return layer.distance == 0.0 || same_within(layer.slack(), centers, layer.centers);
	});
}

bool NearQueue::holds(std::uint32_t layer, std::uint64_t id) const {
	return layer < layers_.size() &&
			std::ranges::any_of(layers_[layer].cells, [id](const auto &entry) { return entry.second.holds(id); });
}

void NearQueue::release(std::uint32_t layer, std::uint64_t id) {
	for (auto &[key, cell] : layers_[layer].cells) {
		cell.release(id);
	}
}

void NearQueue::release(std::uint64_t id) {
	ready_.clear();
	++changes_;
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		release(layer, id);
	}
}

void NearQueue::release_layer(std::uint32_t layer) {
	ready_.clear();
	std::erase_if(due_cells_, [layer](const Renewal &renewal) { return renewal.layer == layer; });
	std::ranges::make_heap(due_cells_, farther);
	layers_[layer].cells.clear();
	layers_[layer].stale = true;
}

} // namespace thicket
