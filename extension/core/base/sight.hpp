#pragma once

#include <algorithm>
#include <limits>

namespace thicket {

// How far away an instance counts from a viewer, for everything that depends on that: which tiles are streamed, how they are thinned,
// which LODs are drawn, and how they fade. scatter_fade.gdshaderinc has the same for shaders.

/// How far a layer is seen.
struct Sight {
	double end = 0.0;  ///< Meters from a viewer at which nothing is drawn any more; 0 for nowhere.
	double fade = 0.0; ///< The share of `end`, up to it, over which instances fade out; 0 for at once.

	/// Meters by which a viewer with this Viewer::radius_scale sees farther, below 0 for one that sees less.
	double beyond(double scale) const { return (scale - 1.0) * end; }

	/// The distance up to which height counts for such a viewer: where the fade-out begins. Height alone never hides an instance.
	double height_limit(double scale) const {
		return end > 0.0 ? std::max((scale - fade) * end, 0.0) : std::numeric_limits<double>::infinity();
	}
};

/// The distance of an instance from a viewer that is so many meters away on the map, and straight in space: straight up to
/// `height_limit`, and on the map beyond that. So what is in view on the map is drawn however high the viewer is, and a high viewer still
/// gets coarse LODs.
inline double sight_distance(double across, double straight, double height_limit) {
	return std::max(across, std::min(straight, height_limit));
}

} // namespace thicket
