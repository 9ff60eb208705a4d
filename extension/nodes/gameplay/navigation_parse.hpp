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

/// The input of a navigation mesh bake, after the engine has parsed all other source geometry.
struct NavigationBake {
	godot::Ref<godot::NavigationMeshSourceGeometryData3D> geometry;
	NavigationAgent agent;
	/// The physics layers whose bodies are baked; empty if no bodies are baked.
	std::optional<std::int64_t> collision_mask;

	// The transform from the engine's space to the bake's space, which is the region's local space:
	// basis * position + origin.
	glm::dmat3 basis{1.0};
	glm::dvec3 origin{0.0};

	// The box to bake, in the bake's space. If there is no box, `min` is above `max`.
	glm::dvec3 min{1.0};
	glm::dvec3 max{-1.0};
};

/// Detects when the engine has parsed all source geometry of a navigation mesh, so that a node can
/// add its instances. The engine calls a parser for each node of the region, in order, and bakes
/// immediately after the last one. Instances can only be queried after all ground geometry is
/// parsed. Therefore they are added at the last node, regardless of the TerrainScatter3D's position
/// in the tree. Use it only on the main thread.
///
/// All nodes share one parser, which is never freed. The engine iterates over a copy of its list of
/// parsers, so it might call a freed parser or miss a new one. The engine calls the first
/// registered node, which forwards the call to the others.
class NavigationParse {
public:
	NavigationParse() = default;
	NavigationParse(const NavigationParse &) = delete;
	NavigationParse &operator=(const NavigationParse &) = delete;
	~NavigationParse() { stop(); }

	/// Makes the engine call `p_method` of `p_node` in every parse, with a NavigationMesh, its
	/// source geometry and the visited node.
	void start(godot::Node3D *p_node, const godot::StringName &p_method);
	void stop();

	/// Handles a call from the engine. Returns true at the last node of a parse that has visited
	/// `p_own_node`, and sets `r_bake` to the input of the bake.
	bool visit(const godot::Ref<godot::NavigationMesh> &p_mesh,
			const godot::Ref<godot::NavigationMeshSourceGeometryData3D> &p_geometry, const godot::Node *p_node,
			const godot::Node *p_own_node, NavigationBake &r_bake);

	/// Sets whether scripts run inside a call to `visit`. The engine is then using the parser's
	/// callback, so `stop` defers replacing it.
	void set_busy(bool busy) { busy_ = busy; }

private:
	void begin(const godot::NavigationMesh &mesh, godot::NavigationMeshSourceGeometryData3D &r_geometry,
			const godot::Node &first);

	bool busy_ = false;

	// The object IDs of the source geometry, the first node and the last node of the parse in
	// progress; 0 if there is none.
	std::uint64_t geometry_id_ = 0;
	std::uint64_t first_id_ = 0;
	std::uint64_t last_id_ = 0;
	/// The number of remaining calls for the last node. The engine may visit it several times,
	/// because a group can contain a node and its ancestors.
	int visits_left_ = 0;
	bool visited_own_node_ = false;
	glm::dmat3 basis_{1.0};
	glm::dvec3 origin_{0.0};
};

} // namespace thicket
