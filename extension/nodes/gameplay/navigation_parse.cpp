#include "nodes/gameplay/navigation_parse.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/classes/navigation_server3d.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <algorithm>
#include <set>
#include <span>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// A node that adds geometry during parses, and the method to call on it.
struct Entry {
	const NavigationParse *parse = nullptr;
	Node3D *node = nullptr;
	StringName method;
};

/// The parser that the engine calls, shared by all nodes.
struct Parser {
	RID rid;
	std::vector<Entry> nodes;

	/// Sets the parser's callback to the method of the first node, or removes it if the list is
	/// empty. If `deferred` is true, does so later, because the engine is running the current
	/// callback.
	void update_callback(bool deferred) const {
		NavigationServer3D *server = NavigationServer3D::get_singleton();
		const Callable callback = nodes.empty() ? Callable() : Callable(nodes.front().node, nodes.front().method);
		if (server != nullptr && deferred) {
			server->call_deferred("source_geometry_parser_set_callback", rid, callback);
		} else if (server != nullptr) {
			server->source_geometry_parser_set_callback(rid, callback);
		}
	}
};

/// Returns the shared parser. It is never freed, because its StringNames must not be destroyed
/// after the engine. Its list is empty once all nodes are freed.
Parser &shared_parser() {
	static Parser *const parser = new Parser; // NOLINT
	return *parser;
}

/// A distance in meters, large enough to recover a region's axes precisely from floats.
constexpr real_t probe_distance = 1 << 20;

/// Forwards a call of the first node to all other nodes. Does nothing if `parse` belongs to another
/// node.
void forward_call(const NavigationParse *parse, const Ref<NavigationMesh> &p_mesh,
		const Ref<NavigationMeshSourceGeometryData3D> &p_geometry, const Node *p_node) {
	const std::vector<Entry> nodes = shared_parser().nodes;
	if (nodes.empty() || nodes.front().parse != parse) {
		return;
	}
	for (const Entry &entry : std::span(nodes).subspan(1)) {
		const auto is_same_parse = [&entry](const Entry &other) {
			return other.parse == entry.parse;
		};
		// A script may have removed the node since then.
		if (std::ranges::any_of(shared_parser().nodes, is_same_parse)) {
			entry.node->call(entry.method, p_mesh, p_geometry, p_node);
		}
	}
}

/// Returns the last node that the engine visits in the branch of `node`.
const Node *last_descendant(const Node *node) {
	while (const int64_t count = node->get_child_count(true)) {
		node = node->get_child(static_cast<int32_t>(count - 1), true);
	}
	return node;
}

const Node *member_of(const TypedArray<Node> &group, int64_t index) {
	return Object::cast_to<Node>(group[index].operator Object *());
}

/// Returns how often the engine visits a node: once if it is in the group, and once more for each
/// ancestor in the group.
int visits_of(const Node *node, const TypedArray<Node> &group) {
	std::set<const Node *> ancestors;
	for (; node != nullptr; node = node->get_parent()) {
		ancestors.insert(node);
	}
	int visits = 0;
	for (int64_t index = 0; index < group.size(); ++index) {
		visits += ancestors.contains(member_of(group, index)) ? 1 : 0;
	}
	return visits;
}

/// Returns the transform from the engine's space to the bake's space. The engine does not expose
/// this transform, but applies it to faces. This function therefore adds probe faces, reads them
/// back and removes them. Returns the identity if the probe faces cannot be read.
Transform3D space_of(NavigationMeshSourceGeometryData3D &r_geometry) {
	const PackedFloat32Array vertices = r_geometry.get_vertices();
	const PackedInt32Array indices = r_geometry.get_indices();
	PackedVector3Array faces;
	const std::span<Vector3> corners = resize(faces, 6);
	corners[1] = Vector3(probe_distance, 0, 0);
	corners[2] = Vector3(0, probe_distance, 0);
	corners[3] = Vector3(0, 0, probe_distance);
	r_geometry.add_faces(faces, Transform3D());
	const PackedFloat32Array all_vertices = r_geometry.get_vertices();
	// `set_indices` accepts at most as many indices as there are floats in the vertices. Most
	// meshes have more indices, so the vertices are padded first.
	r_geometry.set_vertices(resized_copy(vertices, std::max(vertices.size(), indices.size())));
	r_geometry.set_indices(indices);
	r_geometry.set_vertices(vertices);
	if (all_vertices.size() < vertices.size() + 12) {
		return {};
	}
	const float *probe_vertices = all_vertices.ptr() + vertices.size();
	Transform3D space;
	for (int axis = 0; axis < 3; ++axis) {
		space.origin[axis] = probe_vertices[axis];
		space.basis.rows[axis] = Vector3((probe_vertices[3 + axis] - probe_vertices[axis]) / probe_distance,
				(probe_vertices[6 + axis] - probe_vertices[axis]) / probe_distance,
				(probe_vertices[9 + axis] - probe_vertices[axis]) / probe_distance);
	}
	return space;
}

/// Finds the box to bake: the mesh's `filter_baking_aabb`, or the bounds of all geometry if the
/// filter is empty.
void find_box(const NavigationMesh &mesh, NavigationMeshSourceGeometryData3D &r_geometry, NavigationBake &r_bake) {
	const AABB filter = mesh.get_filter_baking_aabb();
	const bool has_filter = filter.size.x > 0 && filter.size.y > 0 && filter.size.z > 0;
	const AABB box = has_filter ? filter : r_geometry.get_bounds();
	r_bake.min = to_core(box.position) + (has_filter ? to_core(mesh.get_filter_baking_aabb_offset()) : glm::dvec3(0.0));
	r_bake.max = r_bake.min + to_core(box.size);
}

} // namespace

void NavigationParse::start(Node3D *p_node, const StringName &p_method) {
	Parser &parser = shared_parser();
	const bool is_registered =
			std::ranges::any_of(parser.nodes, [this](const Entry &entry) { return entry.parse == this; });
	if (is_registered || NavigationServer3D::get_singleton() == nullptr) {
		return;
	}
	if (!parser.rid.is_valid()) {
		parser.rid = NavigationServer3D::get_singleton()->source_geometry_parser_create();
	}
	parser.nodes.push_back({this, p_node, p_method});
	if (parser.nodes.size() == 1) {
		parser.update_callback(false);
	}
}

void NavigationParse::stop() {
	Parser &parser = shared_parser();
	geometry_id_ = 0;
	const bool was_first = !parser.nodes.empty() && parser.nodes.front().parse == this;
	std::erase_if(parser.nodes, [this](const Entry &entry) { return entry.parse == this; });
	if (was_first) {
		parser.update_callback(busy_);
	}
}

/// Starts to track a parse and determines the last node that the engine will visit. The engine
/// visits nodes depth first, or visits a group in tree order.
void NavigationParse::begin(
		const NavigationMesh &mesh, NavigationMeshSourceGeometryData3D &r_geometry, const Node &first) {
	const NavigationMesh::SourceGeometryMode mode = mesh.get_source_geometry_mode();
	const bool with_children = mode != NavigationMesh::SOURCE_GEOMETRY_GROUPS_EXPLICIT;
	const Node *last = &first;
	TypedArray<Node> group;
	if (mode != NavigationMesh::SOURCE_GEOMETRY_ROOT_NODE_CHILDREN) {
		group = first.get_tree()->get_nodes_in_group(mesh.get_source_group_name());
		last = group.is_empty() ? last : member_of(group, group.size() - 1);
	}
	last = with_children ? last_descendant(last) : last;
	visits_left_ = mode == NavigationMesh::SOURCE_GEOMETRY_GROUPS_WITH_CHILDREN ? visits_of(last, group) : 1;
	geometry_id_ = r_geometry.get_instance_id();
	first_id_ = first.get_instance_id();
	last_id_ = last->get_instance_id();
	visited_own_node_ = false;
	const Transform3D space = space_of(r_geometry);
	basis_ = to_core(space.basis);
	origin_ = to_core(space.origin);
}

bool NavigationParse::visit(const Ref<NavigationMesh> &p_mesh,
		const Ref<NavigationMeshSourceGeometryData3D> &p_geometry, const Node *p_node, const Node *p_own_node,
		NavigationBake &r_bake) {
	if (p_mesh.is_null() || p_geometry.is_null() || p_node == nullptr || !p_node->is_inside_tree()) {
		return false;
	}
	forward_call(this, p_mesh, p_geometry, p_node);
	const std::uint64_t node_id = p_node->get_instance_id();
	if (geometry_id_ != p_geometry->get_instance_id() || node_id == first_id_) {
		begin(*p_mesh.ptr(), *p_geometry.ptr(), *p_node);
	}
	visited_own_node_ = visited_own_node_ || p_node == p_own_node;
	if (node_id != last_id_ || --visits_left_ > 0) {
		return false;
	}
	geometry_id_ = 0;
	if (!visited_own_node_) {
		return false;
	}
	r_bake.geometry = p_geometry;
	r_bake.agent = {p_mesh->get_agent_height(), p_mesh->get_agent_max_slope(), p_mesh->get_cell_size(),
			p_mesh->get_cell_height()};
	if (p_mesh->get_parsed_geometry_type() != NavigationMesh::PARSED_GEOMETRY_MESH_INSTANCES) {
		r_bake.collision_mask = p_mesh->get_collision_mask();
	}
	r_bake.basis = basis_;
	r_bake.origin = origin_;
	find_box(*p_mesh.ptr(), *p_geometry.ptr(), r_bake);
	return true;
}

} // namespace thicket
