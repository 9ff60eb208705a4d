#pragma once

#include "core/streaming/tile_streamer.hpp"

#include <numbers>

namespace thicket {

/// The typical area of the tiles around one viewer, in square meters: all tiles that reach into a disc of the view distance.
inline double view_area(const StreamLayer &layer) {
	const double size = layer.tile_size;
	const double reach = layer.view_distance;
	return std::numbers::pi * reach * reach + 4.0 * reach * size + size * size;
}

/// The expected number of instances in this area. The set has `point_density` points per square meter, of which the
/// rules keep the share `density`.
inline double expected_instances(double point_density, double density, const StreamLayer &layer) {
	return point_density * density * view_area(layer);
}

} // namespace thicket
