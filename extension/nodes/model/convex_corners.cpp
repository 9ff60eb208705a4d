#include "nodes/model/convex_corners.hpp"

#include "core/near/body_fit.hpp"

#include <godot_cpp/classes/convex_polygon_shape3d.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

using namespace godot;

namespace thicket {

std::vector<glm::vec3> convex_corners(const Ref<Mesh> &mesh) {
	std::vector<glm::vec3> corners;
	if (mesh.is_null() || mesh->get_surface_count() == 0) {
		return corners;
	}
	const Ref<ConvexPolygonShape3D> hull = mesh->create_convex_shape(true, false);
	const PackedVector3Array points = hull.is_valid() ? hull->get_points() : PackedVector3Array();
	for (const Vector3 &point : points) {
		corners.emplace_back(point.x, point.y, point.z);
	}
	keep_outermost(corners, max_convex_corners);
	return corners;
}

} // namespace thicket
