#include "nodes/common/boxes.hpp"

#include "nodes/common/convert.hpp"

#include <glm/common.hpp>

using namespace godot;

namespace thicket {

AABB joined(const AABB &p_a, const AABB &p_b) {
	const glm::dvec3 min = glm::min(to_core(p_a.position), to_core(p_b.position));
	const glm::dvec3 max = glm::max(to_core(p_a.position + p_a.size), to_core(p_b.position + p_b.size));
	return {to_engine(min), to_engine(max - min)};
}

AABB transformed(const AABB &p_box, const Transform3D &p_transform) {
	const glm::dmat3 basis = to_core(p_transform.basis);
	const glm::dvec3 half = 0.5 * to_core(p_box.size);
	const glm::dvec3 center = basis * (to_core(p_box.position) + half) + to_core(p_transform.origin);
	const glm::dvec3 extent = glm::abs(basis[0]) * half.x + glm::abs(basis[1]) * half.y + glm::abs(basis[2]) * half.z;
	return {to_engine(center - extent), to_engine(2.0 * extent)};
}

} // namespace thicket
