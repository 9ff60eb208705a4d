#pragma once

#include <algorithm>
#include <limits>

namespace thicket {

// The distance between an instance and a viewer. It determines which tiles are streamed, how they are thinned, which
// LODs are drawn, and how they fade. scatter_fade.gdshaderinc computes the same distance in shaders.

/// How far a layer is visible.
struct Sight {
	double end = 0.0;  ///< Meters from a viewer beyond which nothing is drawn; 0 means no limit.
	double fade = 0.0; ///< The share of `end`, up to it, over which instances fade out; 0 to vanish abruptly.

	/// Meters that a viewer with this Viewer::radius_scale sees farther than usual; negative if it sees less far.
	double beyond(double scale) const { return (scale - 1.0) * end; }

	/// The distance up to which height counts for a viewer with this scale: the start of the fade-out. Height alone
	/// never hides an instance.
	double height_limit(double scale) const {
		return end > 0.0 ? std::max((scale - fade) * end, 0.0) : std::numeric_limits<double>::infinity();
	}
};

/// The distance between an instance and a viewer, from their distance on the map (`across`) and in space (`straight`).
/// Up to `height_limit` it is the distance in space, and beyond that the distance on the map. So instances in range on
/// the map are drawn however high the viewer is, and a high viewer still sees coarse LODs.
inline double sight_distance(double across, double straight, double height_limit) {
	return std::max(across, std::min(straight, height_limit));
}

} // namespace thicket
