#pragma once

#include "core/terrain/triangle_terrain.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <vector>

namespace thicket {

/// The meshes of all MeshInstance3Ds in a group of the scene, seen from above. They are read when the ground is first
/// needed, and again by `refresh`.
class ScatterTerrainMeshes : public ScatterTerrain {
	GDCLASS(ScatterTerrainMeshes, ScatterTerrain)

public:
	std::shared_ptr<const Terrain> snapshot() override;
	godot::String problem() override;

	/// The group, in the scene tree of the TerrainScatter3D that uses this ground. Empty: no ground.
	void set_group(const godot::StringName &p_group);
	godot::StringName get_group() const;

	/// Reads the meshes anew, and tells where they have come, gone, moved or changed.
	void refresh();

protected:
	static void _bind_methods();
	void host_changed() override { stale_ = true; }

private:
	/// What tells whether an instance still gives the same ground.
	struct Part {
		std::uint64_t digest = 0; ///< Of its triangles in the world.
		Rect area;
	};
	using Parts = std::map<std::uint64_t, Part>; ///< By the instances' ids.

	std::vector<godot::MeshInstance3D *> instances() const;
	void read();

	godot::StringName group_;
	std::shared_ptr<const TriangleTerrain> ground_;
	Parts parts_;
	bool stale_ = true;
};

} // namespace thicket
