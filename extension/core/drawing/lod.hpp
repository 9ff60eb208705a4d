#pragma once

#include "core/base/sight.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_lods = 15;     ///< Maximum number of meshes in addition to the finest one.
inline constexpr double max_lod_distance = 1e6; ///< Maximum of all LOD distances, in meters.
/// Maximum scale factor that compensates for thinning. It suffices as long as at least 1 in 16
/// instances remains.
inline constexpr double max_scale_compensation = 4.0;

inline constexpr double max_lod_fade = 0.5; ///< Maximum of LodSettings::fade.
inline constexpr double default_lod_fade = 0.1;

/// When a viewer returns, a finer mesh replaces a coarser one at this fraction of the distance at
/// which the coarser one appeared.
inline constexpr double lod_hysteresis = 0.95;

/// The effect of distance on how a layer's tiles and cells are drawn. Distances are measured by
/// sight_distance, in meters, from a viewer to the box of the tile or cell; 0 inside the box.
struct LodSettings {
	/// The distance from which each coarser mesh is drawn, ascending, 0 to max_lod_distance. At
	/// most max_lods entries.
	std::vector<double> lod_distances;

	/// All instances are drawn up to `thin_begin`, and only the fraction `thin_density` from
	/// `thin_end` on. In between, the fraction falls linearly. Both distances are in meters, and
	/// `thin_begin` must not exceed `thin_end`. A density of 1 disables thinning.
	double thin_begin = 0.0;
	double thin_end = 0.0;
	double thin_density = 1.0;

	/// True to enlarge the instances that remain after thinning, so that the total covered area
	/// stays the same.
	bool scale_compensation = false;

	/// The fraction of a distance over which a mesh fades into the next one, or over which the last
	/// mesh fades out before `sight_end`. The fade ends at that distance. 0 means an abrupt change.
	double fade = default_lod_fade;
	double sight_end = 0.0; ///< Distance in meters beyond which nothing is drawn; 0 for no limit.
	bool in_space = false;  ///< See Sight::in_space.

	Sight sight() const { return {sight_end, fade, in_space}; }

	friend bool operator==(const LodSettings &, const LodSettings &) = default;
};

/// Returns an error for values that are not finite or out of range, for LOD distances in descending
/// order, and for a thin_end below thin_begin.
Status validate(const LodSettings &settings);

/// Returns the index of the mesh for a distance: 0 for the finest mesh, or i if the distance is at
/// least lod_distances[i - 1]. `current_lod` is the currently displayed mesh, or 0 if there is
/// none. A finer mesh replaces it only 5 % below the distance of the change. The mesh therefore
/// does not flicker while a viewer moves back and forth.
std::size_t lod_at(const LodSettings &settings, double distance, std::size_t current_lod);

/// Returns the fraction of instances that is drawn at a distance, 0 to 1. The fraction falls in
/// `thin_steps` steps, so that a tile does not change whenever a viewer moves.
double thinned_density(const LodSettings &settings, double distance);
inline constexpr double thin_steps = 64.0;

/// Returns the scale factor for instances if `fraction` of them is drawn: 1 /
/// sqrt(fraction), at most max_scale_compensation. Returns 1 for a layer without compensation.
double compensating_scale(const LodSettings &settings, double fraction);

/// Returns the fraction, 0 to 1, of `wanted_instances` to draw so that there are at most
/// `max_instances`. Returns `fraction`, the current value, unless too many instances would be drawn,
/// or far fewer than allowed. A new fraction uses 90 % of the limit.
double limited_fraction(double fraction, std::uint64_t wanted_instances, std::uint64_t max_instances);

/// Returns how far the distance may change in either direction, in meters, without affecting the
/// result of any function above. The value is at least 0, or infinity if no result depends on the
/// distance.
double distance_margin(const LodSettings &settings, double distance);

} // namespace thicket
