#pragma once

#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/base/unique_number.hpp"
#include "core/placement/host_layer.hpp"
#include "core/placement/instance_data.hpp"
#include "core/placement/placement.hpp"
#include "core/placement/world_source.hpp"
#include "core/rows/row_set.hpp"
#include "core/rules/rules.hpp"
#include "core/sampling/point_set.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

struct LayerSettings;

/// A rule by which a layer depends on the instances of a different layer, its neighbor. The
/// neighbor's instances depend only on its own rules. Layers can form chains but no cycles, because
/// a neighbor's settings must be complete before a layer can refer to them.
struct Neighbor {
	std::shared_ptr<const LayerSettings> layer; ///< The neighbor; never null.
	/// Distance in meters up to which the neighbor's instances have an effect, above 0, at most
	/// max_neighbor_distance.
	double distance = 1.0;

	/// Density as a function of the distance in meters to the neighbor's nearest instance. If no
	/// instance is within `distance`, the density at `distance` applies. If null, the density is 0
	/// below `distance` and 1 beyond it. The distance is measured in the plane, or in space if one
	/// of the two layers is on surfaces.
	std::shared_ptr<const CurveTable> curve;

	friend bool operator==(const Neighbor &, const Neighbor &) = default;
};

inline constexpr double max_neighbor_distance = 1e3;
inline constexpr std::size_t max_neighbors = 16;      ///< Maximum number of neighbors of a layer.
inline constexpr std::size_t max_hosts = 16;          ///< Maximum number of hosts of a layer.
inline constexpr std::size_t max_neighbor_depth = 16; ///< Maximum number of layers in a chain.
/// Maximum number of layers that a layer depends on, including the layer itself.
inline constexpr std::size_t max_graph_layers = 64;

/// The complete settings of a layer, such as a plant species.
struct LayerSettings {
	PointSet set;
	Rules rules;
	Placement placement;
	InstanceData instance_data;
	/// One weight per mesh. The list has at most max_meshes weights, finite, 0 or more, and not all
	/// 0. An instance's mesh is random, with probabilities proportional to the weights. An empty
	/// list means one mesh.
	std::vector<float> mesh_weights;
	/// Rules of single meshes, at most one entry per mesh; no value means no rules. Where an instance
	/// is placed, the weight of a mesh is multiplied by the density of its rules (see MeshRules), so
	/// they decide which meshes grow where, but never whether anything grows. They must have neither
	/// shapes, ground textures, density rules nor an edge feather, and use the water of `rules`.
	std::vector<std::optional<Rules>> mesh_rules;
	/// The sources of the world inputs of all expressions: one for each input (see empty_sources), at
	/// most max_world_sources. The ground has no textures for layers on surfaces.
	std::vector<WorldSource> world_sources;
	/// Spacing and proximity rules with layers that come before this one.
	std::vector<Neighbor> neighbors;
	/// True if the layer fills the gaps that its spacing leaves. The instances of spacing neighbors
	/// then exist before the layer's own points (see Obstacles), so that all remaining gaps get
	/// points. If false, spacing removes points, and the other points stay where they are.
	bool spacing_fills = false;
	/// The planet on which the layer grows, if any. Requires PointSet::on_surface. On a planet,
	/// slopes are relative to the direction away from the center, heights are altitudes, and
	/// upright instances point away from the center.
	Planet planet{};
	/// True if the layer grows on the models of `hosts` instead of the ground. Requires
	/// PointSet::on_surface. If `hosts` is empty, the layer has no points.
	bool hosted = false;
	/// The layers on whose models this layer grows; empty unless `hosted` is true.
	std::vector<HostLayer> hosts;
	/// The rows that contain the layer's points, if PointSet::in_rows is true. Null for no points.
	std::shared_ptr<const RowSet> rows{};
	/// Identifies the settings in an InstanceCache, which requires that they do not change any more.
	UniqueNumber number{};

	friend bool operator==(const LayerSettings &, const LayerSettings &) = default;
};

/// Returns an error if any setting of the layer, or of a layer on which it depends, is invalid.
Status validate(const LayerSettings &layer);

/// Returns true if a layer fills the gaps around a neighbor. Returns false if either layer is on
/// surfaces or the layer is in rows, or for a proximity rule.
bool fills_around(const LayerSettings &layer, const Neighbor &neighbor);

/// Returns true if the layer's points depend on the instances of a neighbor; see
/// LayerSettings::spacing_fills.
bool fills(const LayerSettings &layer);

/// The longest chain of darts, in cells, that occurred in any measurement. A changed obstacle moves
/// no point that is farther away.
inline constexpr std::int32_t fill_chain_cells = 19;

/// Returns true if a density rule of the layer, or of a layer on which it depends, may only be called
/// on the main thread.
bool needs_main_thread(const LayerSettings &layer);

/// Returns true if the transform, mesh or appearance of instances depends on the normal of the
/// ground.
bool follows_normals(const LayerSettings &layer);

/// The longest distance, in radii of the set, from a changed part of a surface to a point that
/// changes as a result. Points on surfaces are accepted one after another, and each may affect the
/// next ones (a chain of darts). No longer chain occurred in any measurement.
inline constexpr double surface_chain_reach = 13.0;

/// The margins of the sampler for layers on the models of hosts. Around a tile, models are placed
/// only within the widest margin, so the sampler cannot use a wider one. The margin exceeds the
/// reach of every chain of darts in the measurements.
inline constexpr SampleMargins host_margins{.first = 16, .widest = 32};

/// Returns how far from a rectangle, in meters, an instance of a host may be and still affect
/// points of `layer` inside the rectangle. `reach` is the result of reach_of or widest_reach_of for
/// the host.
double host_distance(const LayerSettings &layer, double reach);

/// Returns the largest distance in meters at which a change to the ground, a mask or a shape may
/// affect an instance of a valid layer. A change may affect the instance through a chain of layers,
/// along which distances add up. Each layer adds the reach of its edge feather and, on surfaces or
/// if it fills gaps, the reach of a chain of darts. The result is the maximum over all chains.
double reach(const LayerSettings &layer);

/// Returns the approximate number of points that are sampled to generate a square tile of
/// `tile_size` meters of a valid layer. The number includes the points of other layers on which
/// this layer depends, in the tile and around it. Memory and time are proportional to the number.
double points_to_sample(const LayerSettings &layer, double tile_size);

/// Returns the rotation that turns an instance into the direction of its row; no value if the layer's
/// instances do not depend on the direction of rows.
std::optional<Rotation> row_heading(const LayerSettings &layer, std::uint64_t id);

/// Returns the faces of a surface that the slope limits permit. The result changes only when a
/// limit crosses 90 degrees. Other changes to the limits therefore move no points. On a planet, the
/// up direction differs between positions, so all faces are permitted.
SurfaceFaces permitted_faces(const LayerSettings &layer);

} // namespace thicket
