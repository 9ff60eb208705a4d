#include "core/placement/host_layer.hpp"

#include "core/placement/layer.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

HostModels::HostModels(std::vector<std::shared_ptr<const Surface>> models) : models_(std::move(models)) {
	for (const std::shared_ptr<const Surface> &model : models_) {
		if (model != nullptr && !is_empty(model->bounds())) {
			const Box3 &box = model->bounds();
			radius_ = std::max(radius_, glm::length(glm::max(glm::abs(box.min), glm::abs(box.max))));
		}
	}
}

double reach_of(const HostLayer &host) {
	const Placement &placement = host.layer->placement;
	// On the side of a planet, up is horizontal.
	const double lifted = host.layer->planet.exists() ? std::abs(placement.height_offset) : 0.0;
	return host.models->radius() * placement.max_scale + std::abs(placement.offset_along_normal) + lifted;
}

double widest_reach_of(const HostLayer &host) {
	const double placed = host.changes != nullptr ? host.changes->max_scale() : 0.0;
	return std::max(reach_of(host), host.models->radius() * placed);
}

} // namespace thicket
