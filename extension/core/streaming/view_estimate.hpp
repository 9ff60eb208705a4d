#pragma once

#include "core/streaming/tile_streamer.hpp"

#include <numbers>

namespace thicket {

/// Returns the average total area, in square meters, of the tiles within the view distance of one
/// viewer.
inline double view_area(const StreamLayer &layer) {
	const double size = layer.tile_size;
	const double reach = layer.view_distance;
	return std::numbers::pi * reach * reach + 4.0 * reach * size + size * size;
}

/// Returns the expected number of instances in view_area(). `point_density` is the number of points
/// per square meter, and `density` the fraction that the rules keep.
inline double expected_instances(double point_density, double density, const StreamLayer &layer) {
	return point_density * density * view_area(layer);
}

} // namespace thicket
