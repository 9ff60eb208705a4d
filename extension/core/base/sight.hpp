#pragma once

#include <algorithm>
#include <limits>

namespace thicket {

// The sight distance between an instance and a viewer. It determines which tiles are streamed, how
// they are thinned, which LODs are drawn, and how they fade. In shaders, scatter_fade.gdshaderinc
// computes the same distance.

/// The visibility range of a layer.
struct Sight {
	double end = 0.0;  ///< Distance in meters beyond which nothing is drawn; 0 means no limit.
	double fade = 0.0; ///< Length of the fade-out before `end`, as a fraction of `end`; 0 for an abrupt end.
	/// True for layers on planets. Height differences then have no limit, so the sight distance is
	/// the distance in space.
	bool in_space = false;

	/// Returns the distance in meters beyond `end` up to which a viewer with the
	/// Viewer::radius_scale `scale` sees. The result is negative for a scale below 1.
	double beyond(double scale) const { return (scale - 1.0) * end; }

	/// Returns the maximum height difference, in meters, that affects the sight distance of a
	/// viewer with this scale. The limit is the distance at which the fade-out starts, so height
	/// alone never hides an instance.
	double height_limit(double scale) const {
		return end > 0.0 && !in_space ? std::max((scale - fade) * end, 0.0) : std::numeric_limits<double>::infinity();
	}
};

/// Returns the sight distance between an instance and a viewer, from their horizontal distance
/// (`horizontal`) and their distance in space (`straight`). The result is the distance in space up
/// to `height_limit`, and the horizontal distance beyond that. Instances within horizontal range
/// are therefore drawn at any height of the viewer, and a high viewer sees coarse LODs.
inline double sight_distance(double horizontal, double straight, double height_limit) {
	return std::max(horizontal, std::min(straight, height_limit));
}

} // namespace thicket
