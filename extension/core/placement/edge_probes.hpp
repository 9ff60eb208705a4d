#pragma once

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>

namespace thicket {

/// The positions at which a layer checks whether it is near its edge: two rings of eight around a point, at half of the edge distance and
/// at the full distance. Offsets are in units of that distance.
inline constexpr std::size_t edge_probes = 16;

constexpr std::array<glm::dvec2, edge_probes> edge_probe_offsets() {
	constexpr double diagonal = 0.70710678118654752; // cos 45 degrees
	constexpr double wide = 0.92387953251128674;     // cos 22.5 degrees
	constexpr double narrow = 0.38268343236508977;   // sin 22.5 degrees
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

/// The density of a point for which `allowed` of the probes are open: 1 if the layer is allowed all around. Returns 0
/// if half of the surroundings or more are closed to the layer, as on a straight edge.
constexpr double edge_density(std::size_t allowed) {
	const double share = static_cast<double>(allowed) / static_cast<double>(edge_probes);
	return share > 0.5 ? 2.0 * share - 1.0 : 0.0;
}

} // namespace thicket
