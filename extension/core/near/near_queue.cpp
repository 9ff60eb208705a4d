#include "core/near/near_queue.hpp"

#include "core/base/guard.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <new>

namespace thicket {

namespace {

/// Cells that are smaller than this would be many for little, meters.
constexpr double least_side = 4.0;

/// Nothing stands farther from the origin than this, meters; NAN is no position either.
bool possible(glm::dvec3 center) { return std::abs(center.x) < 1e12 && std::abs(center.z) < 1e12; }

} // namespace

NearQueue::Key NearQueue::Layer::key(glm::dvec3 position) const {
	return {static_cast<std::int64_t>(std::floor(position.x / side)),
			static_cast<std::int64_t>(std::floor(position.z / side))};
}

/// Gives the cells another size. What is held stays held. False where memory does not suffice: they stay as they are.
bool NearQueue::Layer::divide(double new_side) {
	Layer next;
	next.side = new_side;
	const Status status = guarded("distance", new_side, [&] {
		for (const auto &[from, cell] : cells) {
			for (const PlacedInstance &instance : cell.held()) {
				if (!next.cells[next.key(instance.position)].hold(instance)) {
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

/// Tells each cell which centers reach it; those that nobody reaches, and that hold nothing, go.
void NearQueue::Layer::find_cells(std::span<const glm::dvec3> now) {
	stale = true; // Should memory not suffice.
	for (auto &[at, cell] : cells) {
		cell.forget_centers();
	}
	const glm::dvec3 reach(leave_share * distance);
	for (const glm::dvec3 &center : now) {
		if (distance == 0.0 || !possible(center)) {
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
	centers.assign(now.begin(), now.end());
	stale = false;
}

void NearQueue::set_distances(std::span<const double> distances) {
	ready_.clear();
	layers_.resize(distances.size());
	for (std::size_t i = 0; i < distances.size(); ++i) {
		Layer &layer = layers_[i];
		if (layer.distance == distances[i]) {
			// Fast path: with the same distance the cells are the same, and what was found holds.
			continue;
		}
		++renewals_;
		layer.distance = distances[i];
		layer.stale = true;
		if (layer.distance > 0.0) {
			layer.divide(std::max(least_side, leave_share * layer.distance));
		}
	}
}

void NearQueue::look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	world_ = &world;
	ready_.clear();
	outdated_.clear();
	looked_ = 0;
	for (std::uint32_t index = 0; index < layers_.size(); ++index) {
		Layer &layer = layers_[index];
		if (layer.stale || !same_within(layer.slack(), centers, layer.centers)) {
			layer.find_cells(centers);
		}
		for (auto &[key, cell] : layer.cells) {
			cell.begin_frame();
			const bool outdated = cell.outdated(layer.slack(), version());
			if (!outdated && !cell.due()) {
				// Fast path: what was found still holds.
				continue;
			}
			outdated_.push_back({index, key, &cell, !outdated});
		}
	}
	std::ranges::stable_sort(
			outdated_, {}, [](const Visit &visit) { return std::pair(visit.due, visit.cell->looked); });
	for (const Visit &visit : outdated_) {
		if (looked_ >= max_looked) {
			break;
		}
		look(visit);
	}
	for (std::uint32_t index = 0; index < layers_.size(); ++index) {
		for (auto &[key, cell] : layers_[index].cells) {
			if (cell.fresh(version()) && (cell.any_leaving() || cell.any_entering())) {
				ready_.push_back({index, key, &cell, false});
			}
		}
	}
}

void NearQueue::look(const Visit &visit) {
	const Layer &layer = layers_[visit.layer];
	const glm::dvec2 corner = layer.side * glm::dvec2(visit.key.first, visit.key.second);
	const NearRange range{enter_share * layer.distance, leave_share * layer.distance};
	looked_ += visit.cell->look(visit.layer, {corner, corner + layer.side}, range, *world_, version(), standing_);
	visit.cell->looked = ++looks_;
}

bool NearQueue::next(bool (NearCell::*any)() const, Leaving &r_leaving) {
	for (const Visit &visit : ready_) {
		if ((visit.cell->*any)()) {
			r_leaving = {visit.layer, visit.cell->take_leaving()};
			return true;
		}
	}
	return false;
}

bool NearQueue::next_changed(PlacedInstance &r_instance) {
	return std::ranges::any_of(
			ready_, [&r_instance](const Visit &visit) { return visit.cell->take_changed(r_instance); });
}

bool NearQueue::next_gone(Leaving &r_leaving) { return next(&NearCell::any_gone, r_leaving); }

bool NearQueue::next_leaving(Leaving &r_leaving) { return next(&NearCell::any_leaving, r_leaving); }

bool NearQueue::next_entering(PlacedInstance &r_instance) {
	NearCell *nearest = nullptr;
	for (const Visit &visit : ready_) {
		if (visit.cell->any_entering() && (nearest == nullptr || visit.cell->away() < nearest->away())) {
			nearest = visit.cell;
		}
	}
	if (nearest == nullptr) {
		return false;
	}
	r_instance = nearest->take_entering();
	return true;
}

bool NearQueue::settled() const {
	return std::ranges::none_of(layers_, [this](const Layer &layer) {
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
	++renewals_;
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		release(layer, id);
	}
}

void NearQueue::release_layer(std::uint32_t layer) {
	ready_.clear();
	layers_[layer].cells.clear();
	layers_[layer].stale = true;
}

} // namespace thicket
