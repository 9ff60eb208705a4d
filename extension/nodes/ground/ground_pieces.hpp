#pragma once

#include "nodes/ground/ground_watch.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec3.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <vector>

namespace thicket {

/// A mesh of a ground node, or triangles that are not from a mesh.
struct GroundPiece {
	godot::Ref<godot::Mesh> mesh;
	std::vector<glm::vec3> corners; ///< Three corners per triangle, clockwise. Used if there is no mesh.
	/// The transforms of all copies in the node's space. If empty, there is one copy in that space.
	std::vector<godot::Transform3D> frames;
};

/// Finds the nodes of a group that have surfaces: MeshInstance3Ds, GridMaps, the outermost nodes of
/// CSG trees, and the CollisionShape3Ds of static bodies. Use it only on the main thread.
class GroundMembers {
public:
	/// Returns the nodes of the group that can be ground, in the scene tree of `p_host`. A static
	/// body is represented by its CollisionShape3Ds.
	std::vector<godot::Variant> list(godot::Node *p_host, const godot::StringName &p_group);

	/// Returns a number that changes when nodes are added to or removed from the group or the
	/// static bodies that `list` has found.
	std::int64_t count(godot::Node *p_host, const godot::StringName &p_group) const;

	/// The group and World3D whose nodes are ground, and the node whose local space their
	/// transforms are in. If `space` is null, transforms are global.
	struct MemberFilter {
		godot::StringName group;
		godot::Ref<godot::World3D> world;
		const godot::Node3D *space = nullptr;
	};

	/// See GroundWatch::ReadState. A node that has left the group or the World3D is not ground.
	GroundNodeState read_state(const godot::Variant &p_node, const MemberFilter &filter, godot::Object *&r_source);

	/// Returns the shape of a member in its local space. Returns no pieces if its collision shape
	/// has no triangles, such as a WorldBoundaryShape3D.
	static std::vector<GroundPiece> pieces(const godot::Variant &p_node);

private:
	using Clock = std::chrono::steady_clock;

	/// The cells of a GridMap when they were last compared.
	struct Cells {
		std::uint64_t digest = 0;
		Clock::time_point next; ///< The time at which to compare them again.
	};

	std::uint64_t cells_of(const godot::Node &grid);

	std::map<std::uint64_t, Cells> cells_; ///< The compared cells of each GridMap, keyed by node ID.
	std::vector<godot::Variant> bodies_;   ///< The static bodies that `list` has found.
};

} // namespace thicket
