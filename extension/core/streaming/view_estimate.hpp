#pragma once

#include "core/streaming/tile_streamer.hpp"

#include <numbers>

namespace thicket {

/// The usual area in square meters of the tiles around one viewer: all that reach into a disc of the view distance.
inline double view_area(const StreamLayer &layer) {
	const double size = layer.tile_size;
	const double reach = layer.view_distance;
	return std::numbers::pi * reach * reach + 4.0 * reach * size + size * size;
}

/// Instances there, if rules keep the share `density` of a set with so many points a square meter.
inline double expected_instances(double point_density, double density, const StreamLayer &layer) {
	return point_density * density * view_area(layer);
}

} // namespace thicket
