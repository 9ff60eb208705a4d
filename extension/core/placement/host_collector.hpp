#pragma once

#include "core/placement/instance_writer.hpp"
#include "core/placement/placed_models.hpp"

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Collects the instances of a layer's hosts around a rectangle into the surface on which the layer
/// grows. Instances that occur in the surfaces of two rectangles have the same order in both.
class HostCollector {
public:
	/// `rect` is the rectangle in which the layer is sampled.
	HostCollector(const LayerSettings &layer, const Rect &rect);

	/// Adds the instances of one host. Call this function for each host, in the order of
	/// LayerSettings::hosts. `points` are the points of the host's filter, with the fractions of
	/// their scales.
	Status add(const HostLayer &host, const PlacedPoints &points);

	/// Sets `r_surface` to the surface of all instances, or to null if there are none. The models
	/// in the settings must outlive it. Returns an error if there are more than
	/// Surface::max_triangles triangles; `r_surface` is then unchanged.
	Status surface(std::unique_ptr<const Surface> &r_surface) const;

private:
	void add_part(const HostLayer &host, const HostInstance &instance);

	Rect around_; ///< Only models that touch this rectangle can affect the layer's points.
	std::vector<PlacedModels::Part> parts_;
	Box3 bounds_ = no_box; ///< The bounds of all parts.
};

} // namespace thicket
