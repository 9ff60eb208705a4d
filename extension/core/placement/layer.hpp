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

/// What another layer's instances mean to the points of a layer. Only the other's own rules decide which of its points are
/// instances, so layers may be chained but never in a ring: the pointers cannot express one.
struct Neighbor {
	std::shared_ptr<const LayerSettings> layer; ///< Never null.
	double distance =
			1.0; ///< Meters, above 0, at most max_neighbor_distance: how far the other layer's instances count.

	/// Density over the distance in meters to the nearest instance of the other layer; where none is within `distance`, the
	/// density at `distance`. Null: nothing stands nearer than `distance`, in the plane, and the rule does not matter beyond.
	std::shared_ptr<const CurveTable> curve;

	friend bool operator==(const Neighbor &, const Neighbor &) = default;
};

inline constexpr double max_neighbor_distance = 1e3;
inline constexpr std::size_t max_neighbors = 16;      ///< Of one layer.
inline constexpr std::size_t max_neighbor_depth = 16; ///< Layers in a row.
inline constexpr std::size_t max_graph_layers = 64;   ///< That a layer depends on, itself included.

/// All that makes a layer: one species or family.
struct LayerSettings {
	PointSet set;
	Rules rules;
	Placement placement;
	InstanceData instance_data;
	/// A weight for each mesh, finite and not negative, not all 0; an instance gets a mesh with a probability
	/// proportional to the weight, from its own hash. None means one mesh. At most max_meshes.
	std::vector<float> mesh_weights;
	/// Spacing and proximity: layers that stand before this one.
	std::vector<Neighbor> neighbors;

	friend bool operator==(const LayerSettings &, const LayerSettings &) = default;
};

/// Refuses a layer of which any part is refused.
Status validate(const LayerSettings &layer);

/// Whether transforms or looks of the instances follow the normal of the ground.
bool follows_normals(const LayerSettings &layer);

/// How far, in meters, a change of the ground, a mask or a shape may reach for the instances of a valid layer: the distances
/// of its neighbors' chains, of what its sources look at, and of edge feathers, added up.
double reach(const LayerSettings &layer);

/// About how many points a square tile of `tile_size` meters of a valid layer takes to make: those of the layer, and of its
/// neighbors and of layers that its sources look at in all the surroundings from which they count. What memory and time grow with.
double points_to_sample(const LayerSettings &layer, double tile_size);

} // namespace thicket
