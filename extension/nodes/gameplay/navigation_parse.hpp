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

	// The space of the bake, which is the region's: basis * engine's position + origin.
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};

	// The box that is baked, in that space; inverted if there is none.
	glm::dvec3 min{1.0};
	glm::dvec3 max{-1.0};
};

/// A node's part in the engine's parses of source geometry for navigation meshes. The engine calls a parser for each node of the region, in
/// order, with the geometry gathered until then, and bakes immediately after the last of them. The instances in a bake can only be queried
/// once all of the ground is there. So the parser adds them at the last node, wherever the scatter is among them. Main thread only.
///
/// All nodes share one parser, which is never freed: the engine works with a copy of its list of parsers. It may keep calling a parser that
/// was freed for a while, and miss one that is new. The engine calls the first of the nodes, which passes the call on to the others.
class NavigationParse {
public:
	NavigationParse() = default;
	NavigationParse(const NavigationParse &) = delete;
	NavigationParse &operator=(const NavigationParse &) = delete;
	~NavigationParse() { stop(); }

	/// From now on the engine calls `p_method` of `p_node` with a NavigationMesh, its source geometry and a node.
	void start(godot::Node3D *p_node, const godot::StringName &p_method);
	void stop();

	/// Handles a call of the engine. True at the end of a parse that has found `p_own`; `r_bake` is then the input of the bake.
	bool visit(const godot::Ref<godot::NavigationMesh> &p_mesh,
			const godot::Ref<godot::NavigationMeshSourceGeometryData3D> &p_geometry, const godot::Node *p_node,
			const godot::Node *p_own, NavigationBake &r_bake);

	/// Set this around code that runs scripts in such a call: the engine is using the parser's callback, so `stop` has the callback
	/// replaced later.
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
