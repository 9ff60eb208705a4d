#include "nodes/ground/ground_pieces.hpp"

#include "core/base/split_mix.hpp"
#include "core/terrain/solid.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/relative_transform.hpp"

#include <godot_cpp/classes/box_shape3d.hpp>
#include <godot_cpp/classes/capsule_shape3d.hpp>
#include <godot_cpp/classes/collision_shape3d.hpp>
#include <godot_cpp/classes/concave_polygon_shape3d.hpp>
#include <godot_cpp/classes/convex_polygon_shape3d.hpp>
#include <godot_cpp/classes/cylinder_shape3d.hpp>
#include <godot_cpp/classes/geometry3d.hpp>
#include <godot_cpp/classes/height_map_shape3d.hpp>
#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/sphere_shape3d.hpp>
#include <godot_cpp/classes/static_body3d.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The minimum time between two comparisons of a GridMap's cells. The time is also at least 200
/// times the duration of the last comparison.
constexpr std::chrono::milliseconds min_interval(100);
constexpr int min_interval_factor = 200;

// These classes are in engine modules, which a custom engine may lack, so their methods are called
// by name.
bool is_grid(const Node &node) { return node.is_class("GridMap"); }
bool is_csg(const Node &node) { return node.is_class("CSGShape3D"); }

/// Returns the alternating transforms and meshes of a GridMap or a CSG tree. Only the outermost node
/// of a CSG tree has any.
Array placed_meshes(Object &r_node) { return r_node.call("get_meshes"); }

std::vector<glm::vec3> to_core_vectors(const PackedVector3Array &p_vectors) {
	std::vector<glm::vec3> result;
	for (const Vector3 &vector : p_vectors) {
		result.emplace_back(to_core(vector));
	}
	return result;
}

/// Returns the triangles of a convex hull. Each triangle that belongs to only one tetrahedron of a
/// triangulation is on the surface.
std::vector<glm::vec3> hull_of(const PackedVector3Array &points) {
	const PackedInt32Array indices = Geometry3D::get_singleton()->tetrahedralize_delaunay(points);
	const auto point = [&](int32_t index) {
		return to_core(points.ptr()[index]);
	};
	// Maps each triangle to the fourth corner of its tetrahedron.
	std::map<std::array<int32_t, 3>, int32_t> outer_triangles;
	for (std::int64_t first = 0; first + 3 < indices.size(); first += 4) {
		for (int omitted = 0; omitted < 4; ++omitted) {
			std::array<int32_t, 3> triangle{};
			for (int corner = 0, next = 0; corner < 4; ++corner) {
				if (corner != omitted) {
					triangle[static_cast<std::size_t>(next++)] = indices.ptr()[first + corner];
				}
			}
			std::ranges::sort(triangle);
			const auto [entry, is_new] = outer_triangles.try_emplace(triangle, indices.ptr()[first + omitted]);
			if (!is_new) {
				outer_triangles.erase(entry);
			}
		}
	}
	std::vector<glm::vec3> corners;
	for (const auto &[triangle, opposite] : outer_triangles) {
		const glm::dvec3 a = point(triangle[0]);
		glm::dvec3 b = point(triangle[1]);
		glm::dvec3 c = point(triangle[2]);
		if (glm::dot(glm::cross(b - a, c - a), point(opposite) - a) < 0.0) {
			std::swap(b, c); // Clockwise, seen from outside.
		}
		corners.insert(corners.end(), {glm::vec3(a), glm::vec3(b), glm::vec3(c)});
	}
	return corners;
}

/// Returns the triangles of a heightmap shape. Its height samples are one meter apart and centered
/// on the origin. A sample of NAN is a hole.
std::vector<glm::vec3> faces_of(const HeightMapShape3D &map) {
	const PackedFloat32Array posts = map.get_map_data();
	const std::int64_t width = map.get_map_width();
	const std::int64_t depth = map.get_map_depth();
	std::vector<glm::vec3> corners;
	const auto post = [&](std::int64_t x, std::int64_t z) {
		return glm::vec3(static_cast<float>(x) - 0.5F * static_cast<float>(width - 1), posts.ptr()[z * width + x],
				static_cast<float>(z) - 0.5F * static_cast<float>(depth - 1));
	};
	if (posts.size() < width * depth) {
		return {};
	}
	for (std::int64_t z = 0; z + 1 < depth; ++z) {
		for (std::int64_t x = 0; x + 1 < width; ++x) {
			const std::array<glm::vec3, 6> patch{
					post(x, z), post(x + 1, z), post(x, z + 1), post(x + 1, z), post(x + 1, z + 1), post(x, z + 1)};
			if (std::ranges::all_of(patch, [](const glm::vec3 &corner) { return std::isfinite(corner.y); })) {
				corners.insert(corners.end(), patch.begin(), patch.end());
			}
		}
	}
	return corners;
}

std::vector<glm::vec3> faces_of(const Object *p_shape) {
	if (const auto *faces = Object::cast_to<ConcavePolygonShape3D>(p_shape)) {
		return to_core_vectors(faces->get_faces());
	}
	if (const auto *hull = Object::cast_to<ConvexPolygonShape3D>(p_shape)) {
		return hull_of(hull->get_points());
	}
	if (const auto *map = Object::cast_to<HeightMapShape3D>(p_shape)) {
		return faces_of(*map);
	}
	std::vector<glm::vec3> corners;
	if (const auto *box = Object::cast_to<BoxShape3D>(p_shape)) {
		append_box(to_core(box->get_size()), corners);
	} else if (const auto *sphere = Object::cast_to<SphereShape3D>(p_shape)) {
		append_capsule(sphere->get_radius(), 2.0 * sphere->get_radius(), corners);
	} else if (const auto *capsule = Object::cast_to<CapsuleShape3D>(p_shape)) {
		append_capsule(capsule->get_radius(), capsule->get_height(), corners);
	} else if (const auto *cylinder = Object::cast_to<CylinderShape3D>(p_shape)) {
		append_cylinder(cylinder->get_radius(), cylinder->get_height(), corners);
	}
	return corners;
}

/// Groups the alternating transforms and meshes of `placed_meshes` by mesh.
std::vector<GroundPiece> pieces_of(const Array &placed) {
	std::vector<GroundPiece> pieces;
	std::map<std::uint64_t, std::size_t> piece_indices; // Maps the ID of a mesh to the index of its piece.
	for (std::int64_t index = 0; index + 1 < placed.size(); index += 2) {
		const Ref<Mesh> mesh = placed[index + 1];
		if (mesh.is_valid()) {
			const auto [entry, is_new] = piece_indices.try_emplace(mesh->get_instance_id(), pieces.size());
			if (is_new) {
				pieces.push_back({mesh, {}, {}});
			}
			pieces[entry->second].frames.push_back(placed[index]);
		}
	}
	return pieces;
}

void mix(std::uint64_t &r_digest, std::uint64_t bits) { r_digest = split_mix(r_digest + split_mix_gamma) ^ bits; }

/// Returns a digest of the cells and the settings that determine the shape of a GridMap.
std::uint64_t digest_of(const Node &grid) {
	std::uint64_t digest = grid.get_instance_id();
	const Vector3 size = grid.get("cell_size");
	const double scale = grid.get("cell_scale");
	for (const double value : {double{size.x}, double{size.y}, double{size.z}, scale}) {
		mix(digest, std::bit_cast<std::uint64_t>(value));
	}
	for (const char *property : {"cell_center_x", "cell_center_y", "cell_center_z"}) {
		mix(digest, static_cast<bool>(grid.get(property)) ? 1 : 0);
	}
	const Variant library = grid.get("mesh_library");
	mix(digest, library.get_validated_object() != nullptr ? library.get_validated_object()->get_instance_id() : 0);
	const Dictionary data = grid.get("data");
	const PackedInt32Array cells = data.get("cells", PackedInt32Array());
	for (const int32_t value : std::span(cells.ptr(), static_cast<std::size_t>(cells.size()))) {
		mix(digest, static_cast<std::uint32_t>(value));
	}
	return digest | 1u; // Never 0, because 0 means that there is no source.
}

} // namespace

std::vector<Variant> GroundMembers::list(Node *p_host, const StringName &p_group) {
	std::vector<Variant> result;
	bodies_.clear();
	if (String(p_group).is_empty()) {
		return result;
	}
	const TypedArray<Node> nodes = p_host->get_tree()->get_nodes_in_group(p_group);
	for (std::int64_t index = 0; index < nodes.size(); ++index) {
		const auto *node = Object::cast_to<Node>(nodes[index].get_validated_object());
		if (node == nullptr) {
			continue;
		}
		if (Object::cast_to<StaticBody3D>(node) != nullptr) {
			bodies_.push_back(nodes[index]);
			for (int32_t child = 0; child < node->get_child_count(); ++child) {
				if (auto *shape = Object::cast_to<CollisionShape3D>(node->get_child(child))) {
					result.emplace_back(shape);
				}
			}
		} else if (Object::cast_to<MeshInstance3D>(node) != nullptr || is_grid(*node) || is_csg(*node)) {
			result.push_back(nodes[index]);
		}
	}
	std::erase_if(cells_, [](const auto &cells) { return Clock::now() > cells.second.next + std::chrono::minutes(1); });
	return result;
}

std::int64_t GroundMembers::count(Node *p_host, const StringName &p_group) const {
	std::int64_t count = p_host->get_tree()->get_node_count_in_group(p_group);
	for (const Variant &body : bodies_) {
		const auto *node = Object::cast_to<Node>(body.get_validated_object());
		count += node != nullptr ? node->get_child_count() : 0;
	}
	return count;
}

/// Returns the digest of a GridMap's cells, which may be a fraction of a second old. The engine emits
/// no signal when cells change.
std::uint64_t GroundMembers::cells_of(const Node &grid) {
	Cells &cells = cells_[grid.get_instance_id()];
	const Clock::time_point start = Clock::now();
	if (cells.digest == 0 || start >= cells.next) {
		cells.digest = digest_of(grid);
		const Clock::time_point end = Clock::now();
		cells.next = end + std::max<Clock::duration>(min_interval, min_interval_factor * (end - start));
	}
	return cells.digest;
}

GroundNodeState GroundMembers::read_state(const Variant &p_node, const MemberFilter &filter, Object *&r_source) {
	const auto *node = Object::cast_to<Node3D>(p_node.get_validated_object());
	if (node == nullptr || !node->is_inside_tree() || !(node->get_world_3d() == filter.world)) {
		return {};
	}
	const auto *shape = Object::cast_to<CollisionShape3D>(node);
	const Node *body = shape != nullptr ? shape->get_parent() : nullptr;
	if (!(body != nullptr ? body : node)->is_in_group(filter.group)) {
		return {};
	}
	const bool is_local = filter.space != nullptr && filter.space->is_inside_tree();
	GroundNodeState state{is_local ? relative_transform(*filter.space, *node) : node->get_global_transform(), 0, 0};
	if (is_grid(*node)) {
		state.source = cells_of(*node);
		return state;
	}
	Ref<Resource> source;
	if (const auto *instance = Object::cast_to<MeshInstance3D>(node)) {
		source = instance->get_mesh();
	} else if (shape != nullptr) {
		source = shape->is_disabled() ? Ref<Shape3D>() : shape->get_shape();
	} else {
		const Array meshes = placed_meshes(*p_node.get_validated_object());
		source = meshes.size() > 1 ? Ref<Mesh>(meshes[1]) : Ref<Mesh>();
	}
	r_source = source.ptr();
	state.source = r_source != nullptr ? r_source->get_instance_id() : 0;
	return state;
}

std::vector<GroundPiece> GroundMembers::pieces(const Variant &p_node) {
	Object *node = p_node.get_validated_object();
	if (const auto *instance = Object::cast_to<MeshInstance3D>(node)) {
		return {{instance->get_mesh(), {}, {}}};
	}
	if (const auto *collision = Object::cast_to<CollisionShape3D>(node)) {
		const Ref<Shape3D> shape = collision->get_shape();
		std::vector<glm::vec3> corners = faces_of(shape.ptr());
		return corners.empty() ? std::vector<GroundPiece>()
							   : std::vector<GroundPiece>{{Ref<Mesh>(), std::move(corners), {}}};
	}
	return node != nullptr ? pieces_of(placed_meshes(*node)) : std::vector<GroundPiece>();
}

} // namespace thicket
