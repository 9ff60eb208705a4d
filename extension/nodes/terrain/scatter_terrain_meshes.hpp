#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/terrain/ground_watch.hpp"
#include "nodes/terrain/mesh_parts.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace thicket {

/// The meshes of all MeshInstance3Ds in a group of the scene, seen from above. They are read when the ground is first needed, and
/// followed from then on: what joins, goes, moves or changes is read anew within half a second or so, on a worker but for the engine's
/// part, and the ground is as it was until then.
class ScatterTerrainMeshes : public ScatterTerrain {
	GDCLASS(ScatterTerrainMeshes, ScatterTerrain)
	THICKET_GUARDED_METHODS

public:
	/// The group, in the scene tree of the TerrainScatter3D that uses this ground. Empty: no ground.
	void set_group(const godot::StringName &p_group);
	godot::StringName get_group() const;

	/// Reads all meshes anew, at once, and tells where they have come, gone, moved or changed.
	void refresh();

	bool is_behind() const override;
	GroundFigures figures() const override { return figures_; }

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;
	void follow() override;
	bool distrust() override;

private:
	/// The ground as a host sees it.
	struct World {
		std::shared_ptr<const TriangleParts> ground;
		GroundMeshes parts;
	};
	using Worlds = std::map<std::uint64_t, World>; ///< By the hosts' ids.

	bool is_in_scene() const;
	std::vector<godot::Variant> members() const;
	GroundWatch::Look look() const;
	void list_members(bool changed);
	bool read_mesh(const godot::Variant &p_node, GroundSight &r_sight, godot::PackedVector3Array &r_faces);
	void read();
	void read_world(const GroundHost &host, World &r_world);
	void read_some();
	std::size_t read_changed(std::uint64_t id);
	void take_built();
	void close(World &r_world);
	void forget_work();
	void tell(const std::vector<Rect> &areas, bool was_empty);
	bool is_empty() const;
	void source_changed(int64_t p_source);

	godot::StringName group_;
	GroundWatch watch_{this, "_source_changed"};
	Worlds worlds_;
	std::shared_ptr<const TriangleParts> last_; ///< Of the first host, for who asks when there is none.
	bool stale_ = true;                         ///< All has to be read.
	std::uint64_t run_ = 0;                     ///< Grows when work under way is forgotten.
	int64_t listed_ = 0;                        ///< How many nodes the group had when it was listed.

	// What has changed goes from one to the next.
	std::vector<std::uint64_t> queue_;  ///< Instances to look at once more, and to read.
	std::vector<MeshReading> readings_; ///< Read.
	std::vector<std::uint64_t> gone_;
	MeshBuilder builder_;
	GroundFigures figures_;
};

} // namespace thicket
