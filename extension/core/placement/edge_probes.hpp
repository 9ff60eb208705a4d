#pragma once

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The number of probes around a point with which a layer detects its edge. They form two rings of
/// eight, at half the edge feather and at the full edge feather. The offsets below are in units of
/// the edge feather.
inline constexpr std::size_t edge_probes = 16;

constexpr std::array<glm::dvec2, edge_probes> edge_probe_offsets() {
	constexpr double diagonal = 0.70710678118654752; // Cosine of 45 degrees.
	constexpr double wide = 0.92387953251128674;     // Cosine of 22.5 degrees.
	constexpr double narrow = 0.38268343236508977;   // Sine of 22.5 degrees.
	constexpr std::array<glm::dvec2, 8> outer{{{1.0, 0.0}, {diagonal, diagonal}, {0.0, 1.0}, {-diagonal, diagonal},
			{-1.0, 0.0}, {-diagonal, -diagonal}, {0.0, -1.0}, {diagonal, -diagonal}}};
	constexpr std::array<glm::dvec2, 8> inner{{{wide, narrow}, {narrow, wide}, {-narrow, wide}, {-wide, narrow},
			{-wide, -narrow}, {-narrow, -wide}, {narrow, -wide}, {wide, -narrow}}};
	std::array<glm::dvec2, edge_probes> offsets{};
	for (std::size_t i = 0; i < outer.size(); ++i) {
		offsets[i] = outer[i];
		offsets[outer.size() + i] = {0.5 * inner[i].x, 0.5 * inner[i].y};
	}
	return offsets;
}

/// Returns the largest distance, in meters, at which an edge feather samples the ground around a
/// point. On a surface, a probe's distance from the tangent plane may be as large as its distance
/// within this plane.
constexpr double edge_reach(double edge_feather, bool on_surface) {
	constexpr double diagonal = 1.4142135623730951; // Square root of 2.
	return on_surface ? diagonal * edge_feather : edge_feather;
}

/// Returns the density at a point if the layer is allowed at `allowed` of its probes. The density
/// is 0 if the layer is allowed at half of them or fewer, as on a straight edge. From there, it
/// rises linearly to 1 if the layer is allowed at all of them.
constexpr double edge_density(std::size_t allowed) {
	const double fraction = static_cast<double>(allowed) / static_cast<double>(edge_probes);
	return fraction > 0.5 ? 2.0 * fraction - 1.0 : 0.0;
}

} // namespace thicket
