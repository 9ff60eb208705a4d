#pragma once

#include "core/placement/edge_probes.hpp"
#include "core/terrain/surface.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// An edge probe of a point on a surface.
struct SurfaceProbe {
	glm::dvec3 position{0.0}; ///< On the surface or, if there is none, in the tangent plane of the point.
	glm::dvec3 normal{0.0};   ///< The unit normal of the surface; 0 if there is none.
	bool on_surface = false;  ///< True if the surface continues as far as this probe.
};

/// Finds the edge probes of points on a surface. An object of this class reuses its memory.
class SurfaceProbes {
public:
	/// Writes the probes of a point. They lie in its tangent plane, and are then moved along the
	/// normal to the nearest front face. If there is none within the probe's distance from the
	/// point, the surface is assumed to end before the probe: it has a border there, or bends by
	/// more than 45 degrees. On level ground, the probes are those of edge_probe_offsets. Throws
	/// std::bad_alloc.
	void find(const Surface &surface, const glm::dvec3 &position, const glm::dvec3 &normal, double edge_feather,
			std::span<SurfaceProbe, edge_probes> r_probes);

private:
	std::vector<std::uint32_t> triangles_;
};

} // namespace thicket
