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

/// What a navigation mesh is about to be baked from, once the engine has gathered all of it.
struct NavigationBake {
	godot::Ref<godot::NavigationMeshSourceGeometryData3D> geometry;
	NavigationAgent agent;
	std::optional<std::int64_t> collision_mask; ///< The physics layers that count; none where no bodies are asked for.

	// The space of the bake, which is the region's: basis * engine's position + origin.
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};

	// The box that is baked, in that space; inverted for none.
	glm::dvec3 min{1.0};
	glm::dvec3 max{-1.0};
};

/// A node's part in the engine's parses of source geometry for navigation meshes. The engine calls a parser for each node of the region,
/// in order, with the geometry so far, and bakes at once after the last of them. What stands in a bake can be asked for only once all of the
/// ground is there, so the answer is given at the last node, wherever the scatter is among them. Main thread only.
///
/// All nodes share one parser, which stays: the engine works with a copy of its list of parsers, and may go on for a while with one that was
/// freed, and without one that is new. It calls the first of the nodes, which hands the call on to the others.
class NavigationParse {
public:
	NavigationParse() = default;
	NavigationParse(const NavigationParse &) = delete;
	NavigationParse &operator=(const NavigationParse &) = delete;
	~NavigationParse() { stop(); }

	/// From now on the engine calls `p_method` of `p_node` with a NavigationMesh, its source geometry and a node.
	void start(godot::Node3D *p_node, const godot::StringName &p_method);
	void stop();

	/// A call of the engine. True at the end of a parse that has found `p_own`; then `r_bake` is what is baked.
	bool visit(const godot::Ref<godot::NavigationMesh> &p_mesh,
			const godot::Ref<godot::NavigationMeshSourceGeometryData3D> &p_geometry, const godot::Node *p_node,
			const godot::Node *p_own, NavigationBake &r_bake);

	/// Around what runs scripts in such a call: the engine is using the parser's callback, so `stop` has that replaced later.
	void set_busy(bool busy) { busy_ = busy; }

private:
	void begin(const godot::NavigationMesh &mesh, godot::NavigationMeshSourceGeometryData3D &r_geometry,
			const godot::Node &first);

	bool busy_ = false;

	// The parse under way, by the ids of objects; 0 for none.
	std::uint64_t geometry_ = 0;
	std::uint64_t first_ = 0;
	std::uint64_t last_ = 0;
	int visits_left_ = 0; ///< Of the last node: a group may have a node and one above it.
	bool found_ = false;
	glm::dmat3 basis_{1.0};
	glm::dvec3 origin_{0.0};
};

} // namespace thicket
