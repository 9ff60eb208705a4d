#pragma once

#include "core/base/sight.hpp"
#include "core/base/status.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

inline constexpr std::size_t max_lods = 15;           ///< Meshes for the distance, the one for near by not counted.
inline constexpr double max_lod_distance = 1e6;       ///< Meters.
inline constexpr double max_scale_compensation = 4.0; ///< What is left makes up for 15 in 16 that are gone, at most.

inline constexpr double max_lod_fade = 0.5;
inline constexpr double usual_lod_fade = 0.1;

inline constexpr double lod_hysteresis =
		0.95; ///< A finer mesh comes back at this share of the distance at which it went.

/// How a layer's tiles and their cells are drawn with distance. Distances are meters from a viewer to the box of what is drawn
/// as one, as sight_distance measures, 0 inside it.
struct LodSettings {
	/// Where the next coarser mesh begins, ascending, 0 to max_lod_distance; at most max_lods.
	std::vector<double> lod_distances;

	/// All instances stand up to `thin_begin`, the share `thin_density` from `thin_end` on, in between the share falls
	/// evenly. Meters, begin <= end; a density of 1 thins nothing.
	double thin_begin = 0.0;
	double thin_end = 0.0;
	double thin_density = 1.0;

	/// Enlarges what is left of thinned instances, so that they cover as much as all of them did.
	bool scale_compensation = false;

	/// The share of a distance, up to it, over which a mesh becomes the next one, or the last one goes at `sight_end`; 0 for at once.
	double fade = usual_lod_fade;
	double sight_end = 0.0; ///< Where nothing is drawn any more. Meters; 0 for nowhere.

	Sight sight() const { return {sight_end, fade}; }

	friend bool operator==(const LodSettings &, const LodSettings &) = default;
};

/// Refuses what is not finite or out of range, distances that do not ascend, an end before its beginning.
Status validate(const LodSettings &settings);

/// The mesh for a distance: 0 near by, i from lod_distances[i - 1] on. `shown` is the one that is shown now: it gives way to
/// a finer one only 5 % nearer than where it began, so that who walks to and fro sees no flicker. For what is not
/// shown yet, pass 0.
std::size_t lod_at(const LodSettings &settings, double distance, std::size_t shown);

/// The share of instances that stands at a distance, 0 to 1. It falls in `thin_steps` steps: a tile changes that often and
/// not with every step of a viewer.
double thinned_density(const LodSettings &settings, double distance);
inline constexpr double thin_steps = 64.0;

/// What to scale the instances by where this share is left: 1 / sqrt(share), at most max_scale_compensation, or 1 for a layer
/// that does not compensate.
double compensating_scale(const LodSettings &settings, double share);

/// The share of what is wanted that keeps what is drawn below `most`, given the share so far: it changes only where too much
/// would be drawn, or far less than may be, and then leaves room for a tenth more. 0 to 1.
double limited_share(double share, std::uint64_t wanted, std::uint64_t most);

/// How much the distance may change, either way, before anything above may answer otherwise. Meters, 0 or more, infinite
/// where nothing depends on the distance.
double distance_margin(const LodSettings &settings, double distance);

} // namespace thicket
