#include "core/near/near_queue.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Centers nearer to each other than this share of the distance are asked for together.
constexpr double crowd_share = 0.5;

double squared(glm::dvec3 a, glm::dvec3 b) { return glm::dot(a - b, a - b); }

} // namespace

bool NearQueue::Layer::outdated(std::span<const glm::dvec3> now, std::uint64_t world_version) {
	if (!wanted()) {
		return stale;
	}
	if (stale || again || ++frames >= look_frames || version != world_version || now.size() != centers.size()) {
		return true;
	}
	const double slack = look_share * distance;
	for (std::size_t i = 0; i < now.size(); ++i) {
		if (squared(now[i], centers[i]) > slack * slack) {
			return true;
		}
	}
	return false;
}

void NearQueue::Layer::forget_changes() {
	changes = {};
	left = 0;
	entered = 0;
	stale = true;
}

void NearQueue::set_distances(std::span<const double> distances) {
	layers_.resize(distances.size());
	for (std::size_t i = 0; i < distances.size(); ++i) {
		layers_[i].stale = layers_[i].stale || layers_[i].distance != distances[i];
		layers_[i].distance = distances[i];
	}
}

void NearQueue::look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	world_ = &world;
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		if (layers_[layer].outdated(centers, world.version())) {
			look(layer, centers, world);
		}
	}
}

void NearQueue::look(std::uint32_t layer, std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	Layer &of = layers_[layer];
	find_standing(layer, centers, world);
	of.near.look(centers, {enter_share * of.distance, leave_share * of.distance}, standing_, of.changes);
	of.left = 0;
	of.entered = 0;
	of.stale = of.again = false;
	of.frames = 0;
	of.version = world.version();
	of.centers.assign(centers.begin(), centers.end());
	of.away.clear();
	for (const PlacedInstance &instance : of.changes.enter) {
		double nearest = std::numeric_limits<double>::infinity();
		for (const glm::dvec3 &center : centers) {
			nearest = std::min(nearest, squared(center, instance.position));
		}
		of.away.push_back(nearest);
	}
}

void NearQueue::find_standing(std::uint32_t layer, std::span<const glm::dvec3> centers, const InstanceWorld &world) {
	standing_.clear();
	const double distance = layers_[layer].distance;
	if (distance == 0.0 || layer >= world.layers().size()) {
		return;
	}
	// Of a crowd only one asks, for the others too.
	const double crowd = crowd_share * distance;
	covered_.assign(centers.size(), false);
	for (std::size_t i = 0; i < centers.size(); ++i) {
		if (covered_[i]) {
			continue;
		}
		double farthest = 0.0;
		for (std::size_t k = i + 1; k < centers.size(); ++k) {
			const double apart = squared(centers[i], centers[k]);
			if (apart <= crowd * crowd) {
				covered_[k] = true;
				farthest = std::max(farthest, apart);
			}
		}
		world.known_near(layer, {centers[i].x, centers[i].z}, leave_share * distance + std::sqrt(farthest), standing_);
	}
}

bool NearQueue::next(bool (Layer::*any)() const, Leaving &r_leaving) {
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		Layer &of = layers_[layer];
		if (!of.stale && (of.*any)()) {
			r_leaving = {layer, of.changes.leave[of.left++]};
			of.near.release(r_leaving.id);
			return true;
		}
	}
	return false;
}

bool NearQueue::next_changed(PlacedInstance &r_instance) {
	for (Layer &layer : layers_) {
		NearChanges &changes = layer.changes;
		const auto first = changes.enter.begin() + static_cast<std::ptrdiff_t>(layer.entered);
		const auto held = std::find_if(first, changes.enter.end(),
				[&layer](const PlacedInstance &instance) { return layer.near.holds(instance.id); });
		if (layer.stale || held == changes.enter.end()) {
			continue;
		}
		r_instance = *held;
		layer.near.hold(r_instance);
		layer.away.erase(layer.away.begin() + (held - changes.enter.begin()));
		changes.enter.erase(held);
		const auto leaves = std::find(
				changes.leave.begin() + static_cast<std::ptrdiff_t>(layer.left), changes.leave.end(), r_instance.id);
		if (leaves != changes.leave.end()) {
			changes.gone -= leaves - changes.leave.begin() < static_cast<std::ptrdiff_t>(changes.gone) ? 1 : 0;
			changes.leave.erase(leaves);
		}
		return true;
	}
	return false;
}

bool NearQueue::next_gone(Leaving &r_leaving) { return next(&Layer::any_gone, r_leaving); }

bool NearQueue::next_leaving(Leaving &r_leaving) { return next(&Layer::any_leaving, r_leaving); }

bool NearQueue::next_entering(PlacedInstance &r_instance) {
	Layer *nearest = nullptr;
	for (Layer &layer : layers_) {
		const bool candidate = !layer.stale && layer.any_entering();
		if (candidate && (nearest == nullptr || layer.away[layer.entered] < nearest->away[nearest->entered])) {
			nearest = &layer;
		}
	}
	if (nearest == nullptr) {
		return false;
	}
	r_instance = nearest->changes.enter[nearest->entered++];
	nearest->near.hold(r_instance);
	return true;
}

bool NearQueue::settled() const {
	return std::none_of(layers_.begin(), layers_.end(), [this](const Layer &layer) {
		const bool outdated = world_ == nullptr || layer.version != world_->version();
		return layer.wanted() &&
				(layer.stale || layer.again || outdated || layer.any_leaving() || layer.any_entering());
	});
}

bool NearQueue::holds(std::uint32_t layer, std::uint64_t id) const {
	return layer < layers_.size() && layers_[layer].near.holds(id);
}

void NearQueue::release(std::uint32_t layer, std::uint64_t id) {
	layers_[layer].near.release(id);
	layers_[layer].again = true;
}

void NearQueue::release(std::uint64_t id) {
	for (Layer &layer : layers_) {
		layer.near.release(id);
		layer.forget_changes();
	}
}

void NearQueue::release_layer(std::uint32_t layer) {
	layers_[layer].near.clear();
	layers_[layer].forget_changes();
}

} // namespace thicket
