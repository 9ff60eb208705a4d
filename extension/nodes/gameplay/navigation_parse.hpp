#pragma once

#include "core/near/obstruction.hpp"

#include <godot_cpp/classes/navigation_mesh.hpp>
#include <godot_cpp/classes/navigation_mesh_source_geometry_data3d.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>

namespace thicket {

/// The input of a navigation mesh bake, once the engine has gathered all of it.
struct NavigationBake {
	godot::Ref<godot::NavigationMeshSourceGeometryData3D> geometry;
	NavigationAgent agent;
	std::optional<std::int64_t> collision_mask; ///< The physics layers that count; empty if bodies do not count.

	// The space of the bake, which is the region's own: basis * engine's position + origin.
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};

	// The box that is baked, in that space; inverted if there is none.
	glm::dvec3 min{1.0};
	glm::dvec3 max{-1.0};
};

/// A node's part in the engine's parses of source geometry for navigation meshes. For each node of the region, in
/// order, the engine calls a parser with the geometry gathered until then. It bakes immediately after the last node.
/// The instances in a bake can only be queried once all of the ground is gathered. So the parser adds them at the last
/// node, wherever the scatter is in the tree. Main thread only.
///
/// All nodes share one parser, which is never freed. The engine works with a copy of its list of parsers, so for a
/// while it may call a freed parser, or miss a new one. The engine calls the first of the nodes, which forwards the
/// call to the others.
class NavigationParse {
public:
	NavigationParse() = default;
	NavigationParse(const NavigationParse &) = delete;
	NavigationParse &operator=(const NavigationParse &) = delete;
	~NavigationParse() { stop(); }

	/// From now on the engine calls `p_method` of `p_node` with a NavigationMesh, its source geometry and a node.
	void start(godot::Node3D *p_node, const godot::StringName &p_method);
	void stop();

	/// Handles a call of the engine. Returns true at the end of a parse that has found `p_own`, and sets `r_bake` to
	/// the input of the bake.
	bool visit(const godot::Ref<godot::NavigationMesh> &p_mesh,
			const godot::Ref<godot::NavigationMeshSourceGeometryData3D> &p_geometry, const godot::Node *p_node,
			const godot::Node *p_own, NavigationBake &r_bake);

	/// Set this while code in such a call runs scripts. The engine is then using the parser's callback, so `stop`
	/// replaces the callback later.
	void set_busy(bool busy) { busy_ = busy; }

private:
	void begin(const godot::NavigationMesh &mesh, godot::NavigationMeshSourceGeometryData3D &r_geometry,
			const godot::Node &first);

	bool busy_ = false;

	// The parse in progress, by object IDs; 0 if there is none.
	std::uint64_t geometry_ = 0;
	std::uint64_t first_ = 0;
	std::uint64_t last_ = 0;
	int visits_left_ = 0; ///< Remaining calls for the last node: a group may have a node and an ancestor of it.
	bool found_ = false;
	glm::dmat3 basis_{1.0};
	glm::dvec3 origin_{0.0};
};

} // namespace thicket
