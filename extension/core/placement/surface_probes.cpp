#include "core/placement/surface_probes.hpp"

#include "core/base/tangent_axes.hpp"
#include "core/terrain/surface_line.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

constexpr std::array<glm::dvec2, edge_probes> probe_offsets = edge_probe_offsets();

} // namespace

void SurfaceProbes::find(const Surface &surface, const glm::dvec3 &position, const glm::dvec3 &normal,
		double edge_feather, std::span<SurfaceProbe, edge_probes> r_probes) {
	const glm::dvec3 up = glm::normalize(normal);
	const auto [along, across] = tangent_axes(up);
	for (std::size_t i = 0; i < r_probes.size(); ++i) {
		const glm::dvec2 offset = edge_feather * probe_offsets[i];
		const double far = std::sqrt(offset.x * offset.x + offset.y * offset.y);
		const glm::dvec3 probe = position + offset.x * along + offset.y * across;
		const glm::dvec3 top = probe + far * up;
		const glm::dvec3 bottom = probe - far * up;
		surface.find({glm::min(top, bottom), glm::max(top, bottom)}, triangles_);
		r_probes[i] = {probe, glm::dvec3(0.0), false};
		double min_distance = far;
		for (const std::uint32_t index : triangles_) {
			const double distance = distance_along(surface.triangle(index), probe, up);
			if (std::abs(distance) < min_distance) {
				min_distance = std::abs(distance);
				r_probes[i] = {probe + distance * up, glm::normalize(surface.cross(index)), true};
			}
		}
	}
}

} // namespace thicket
