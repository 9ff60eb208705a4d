#pragma once

#include "core/base/sight.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_lods = 15;     ///< Meshes for the distance, not counting the nearest one.
inline constexpr double max_lod_distance = 1e6; ///< Meters.
/// Limits the compensation for thinning: the remaining instances can make up for at most 15 in 16 removed ones.
inline constexpr double max_scale_compensation = 4.0;

inline constexpr double max_lod_fade = 0.5;
inline constexpr double usual_lod_fade = 0.1;

/// A finer mesh returns at this share of the distance at which it was replaced.
inline constexpr double lod_hysteresis = 0.95;

/// How a layer's tiles and their cells are drawn depending on distance. Distances are in meters, as sight_distance
/// measures, from a viewer to the box of the tile or cell; 0 inside the box.
struct LodSettings {
	/// The distances at which each coarser mesh begins, ascending, 0 to max_lod_distance; at most max_lods.
	std::vector<double> lod_distances;

	/// All instances are drawn up to `thin_begin`, and the share `thin_density` from `thin_end` on. In between, the share falls linearly.
	/// Meters, begin <= end; a density of 1 disables thinning.
	double thin_begin = 0.0;
	double thin_end = 0.0;
	double thin_density = 1.0;

	/// Enlarges the instances that remain after thinning, so that they cover as much as all of them did.
	bool scale_compensation = false;

	/// The share of a distance over which a mesh fades into the next one, or the last mesh fades out at `sight_end`.
	/// The fade ends at the distance itself. 0 means an abrupt change.
	double fade = usual_lod_fade;
	double sight_end = 0.0; ///< The distance beyond which nothing is drawn. Meters; 0 for no limit.

	Sight sight() const { return {sight_end, fade}; }

	friend bool operator==(const LodSettings &, const LodSettings &) = default;
};

/// Refuses values that are not finite or out of range, distances that do not ascend, and an end before its beginning.
Status validate(const LodSettings &settings);

/// The mesh for a distance: 0 is the nearest, and mesh i is drawn from lod_distances[i - 1] on. `shown` is the mesh
/// that is displayed now. A finer mesh replaces it only at a distance 5 % below the one at which it began, so that a
/// viewer who moves back and forth sees no flicker. Pass 0 if nothing is displayed yet.
std::size_t lod_at(const LodSettings &settings, double distance, std::size_t shown);

/// The share of instances that is drawn at a distance, 0 to 1. The share falls in `thin_steps` steps. So a tile changes
/// that often, and not with every step of a viewer.
double thinned_density(const LodSettings &settings, double distance);
inline constexpr double thin_steps = 64.0;

/// The scale factor for instances if this share of them is drawn: 1 / sqrt(share), at most max_scale_compensation.
/// Returns 1 for a layer without compensation.
double compensating_scale(const LodSettings &settings, double share);

/// The share of the `wanted` instances to draw so that there are at most `most`, given the current share. Changes the
/// share only if too many would be drawn, or far fewer than allowed. A new share leaves room for a tenth more. 0 to 1.
double limited_share(double share, std::uint64_t wanted, std::uint64_t most);

/// How much the distance may change, in either direction, before any function above may return a different result.
/// Meters, 0 or more; infinite if no result depends on the distance.
double distance_margin(const LodSettings &settings, double distance);

} // namespace thicket
