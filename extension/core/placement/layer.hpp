#pragma once

#include "core/base/status.hpp"
#include "core/placement/instance_data.hpp"
#include "core/placement/placement.hpp"
#include "core/rules/rules.hpp"
#include "core/sampling/point_set.hpp"

#include <cstddef>
#include <memory>
#include <vector>

namespace thicket {

struct LayerSettings;

/// How the points of a layer depend on the instances of a different layer. A neighbor's own rules alone decide which of
/// its points are instances. So layers can form chains but never cycles, which the pointers cannot express.
struct Neighbor {
	std::shared_ptr<const LayerSettings> layer; ///< Never null.
	/// Meters, above 0, at most max_neighbor_distance: the distance up to which the other layer's instances count.
	double distance = 1.0;

	/// Density over the distance in meters to the nearest instance of the other layer. If none is within `distance`, the density at
	/// `distance` applies. Null: no instance is placed nearer than `distance`, in the plane, and the rule has no effect beyond.
	std::shared_ptr<const CurveTable> curve;

	friend bool operator==(const Neighbor &, const Neighbor &) = default;
};

inline constexpr double max_neighbor_distance = 1e3;
inline constexpr std::size_t max_neighbors = 16;      ///< The most neighbors of one layer.
inline constexpr std::size_t max_neighbor_depth = 16; ///< The most layers in a chain.
inline constexpr std::size_t max_graph_layers = 64;   ///< The most layers that a layer depends on, itself included.

/// The complete settings of a layer, which is one species or family.
struct LayerSettings {
	PointSet set;
	Rules rules;
	Placement placement;
	InstanceData instance_data;
	/// A weight for each mesh, finite and not negative, not all 0. An instance gets a mesh with a probability proportional to its weight,
	/// from the instance's own hash. An empty list means one mesh. At most max_meshes.
	std::vector<float> mesh_weights;
	/// Spacing and proximity: the layers before this one that it depends on.
	std::vector<Neighbor> neighbors;

	friend bool operator==(const LayerSettings &, const LayerSettings &) = default;
};

/// Refuses a layer if any part of it is invalid.
Status validate(const LayerSettings &layer);

/// True if transforms or looks of the instances depend on the normal of the ground.
bool follows_normals(const LayerSettings &layer);

/// How far, in meters, a change of the ground, a mask or a shape may affect the instances of a valid layer. This is the sum of the
/// distances of its neighbors' chains, of its sources, and of edge feathers.
double reach(const LayerSettings &layer);

/// The approximate number of points that are sampled to generate a square tile of `tile_size` meters of a valid layer.
/// The number includes the points of the layer, and the points of neighbors and source layers in the surroundings where
/// they count. Memory and time grow with it.
double points_to_sample(const LayerSettings &layer, double tile_size);

} // namespace thicket
