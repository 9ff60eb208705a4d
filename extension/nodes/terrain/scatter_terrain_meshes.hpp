#pragma once

#include "core/terrain/triangle_terrain.hpp"
#include "nodes/common/guard.hpp"
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
	THICKET_GUARDED_METHODS

public:
	/// What tells whether an instance still gives the same ground.
	struct Part {
		std::uint64_t digest = 0; ///< Of its triangles in the world.
		Rect area;
	};
	using Parts = std::map<std::uint64_t, Part>; ///< By the instances' ids.

	/// The group, in the scene tree of the TerrainScatter3D that uses this ground. Empty: no ground.
	void set_group(const godot::StringName &p_group);
	godot::StringName get_group() const;

	/// Reads the meshes anew, and tells where they have come, gone, moved or changed.
	void refresh();

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	void hosts_changed(bool first) override;

private:
	/// The ground in the world of all hosts that have the same offset.
	struct World {
		std::shared_ptr<const TriangleTerrain> ground;
		Parts parts;
	};

	std::vector<godot::Variant> instances() const;
	using Worlds = std::map<std::uint64_t, std::shared_ptr<const World>>; ///< By the hosts' ids.

	void read();
	bool add_world(const GroundHost &host, Worlds &r_worlds);
	bool read_world(glm::dvec3 offset, World &r_world) const;

	godot::StringName group_;
	Worlds worlds_;
	std::shared_ptr<const World> last_; ///< Of the first host.
	bool stale_ = true;
};

} // namespace thicket
