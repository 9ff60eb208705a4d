#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/common/worker_task.hpp"
#include "nodes/ground/ground_watch.hpp"
#include "nodes/ground/mesh_parts.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/mesh_instance3d.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <glm/vec3.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

/// The meshes of all MeshInstance3Ds in a group of the scene, seen from above. They are read when a node first needs
/// the ground. From then on, if an instance is added, removed, moved or changed, the ground follows within about half a
/// second. The main thread copies a mesh's data from the renderer, in steps. A worker then builds the ground. The
/// previous ground remains until then.
class ScatterGroundMeshes : public ScatterGround {
	GDCLASS(ScatterGroundMeshes, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundMeshes";

	/// The group, in the scene tree of the TerrainScatter3D that uses this ground. If empty, there is no ground.
	void set_group(const godot::StringName &p_group);
	godot::StringName get_group() const;

	/// Rereads all meshes immediately, and reports where meshes were added, removed, moved or changed.
	void refresh();

	bool is_behind() const override;
	bool is_pending(std::uint64_t host) const override;
	void finish_reading() override;
	GroundFigures figures() const override { return figures_; }

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	godot::String find_remark() override;
	godot::String find_stripped() override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;
	void follow() override;
	bool distrust() override;

private:
	/// A mesh that was read for an instance.
	struct FreshCopy {
		std::uint64_t id = 0;
		std::uint64_t version = 0;
		std::shared_ptr<const MeshCopy> copy;
	};
	using Worlds = std::map<std::uint64_t, GroundWorld>; ///< By the hosts' IDs.

	bool is_in_scene() const;
	std::vector<godot::Variant> members() const;
	GroundWatch::Look look() const;
	void list_members(bool changed);
	void begin();
	void queue_all();
	void add_worlds();
	void read_some(std::chrono::steady_clock::time_point deadline);
	void plan_next();
	bool plan(std::uint64_t id);
	std::vector<MeshReading> readings_of(std::uint64_t id, const GroundSight &sight) const;
	void read_step();
	bool lacks_ground() const;
	void build(bool wait);
	void take_built();
	void take_refusals(const MeshWork &work);
	void refuse(std::uint64_t id, const godot::String &p_why);
	void forget_work();
	void tell(const std::vector<Rect> &areas, bool was_empty);
	bool is_empty() const;
	void source_changed(int64_t p_source);

	godot::StringName group_;
	GroundWatch watch_{this, "_source_changed"};
	Worlds worlds_;
	std::shared_ptr<const TriangleParts> last_; ///< The ground of the first host, for a caller without one.
	bool stale_ = true;                         ///< True if the group must be listed, and all of it read.
	bool reading_all_ = false;                  ///< True once the listing has begun.
	int64_t listed_ = 0;                        ///< The number of nodes in the group when it was listed.

	// A change passes through these in order.
	std::vector<std::uint64_t> queue_;  ///< Instances to check, and to read.
	MeshReader reader_;                 ///< Reads the mesh of the last of them.
	FreshCopy fresh_;                   ///< The mesh of that instance, once it is read.
	std::vector<MeshReading> readings_; ///< Meshes that are read and wait for the builder.
	std::vector<std::uint64_t> gone_;
	WorkerTask<MeshWork> builder_;
	bool building_ = false; ///< False if the builder only frees memory.

	std::map<std::uint64_t, std::pair<std::uint64_t, std::weak_ptr<const MeshCopy>>>
			copies_;                                  ///< By source, with its version.
	std::map<std::uint64_t, godot::String> refusals_; ///< Why an instance is not ground, by its ID.
	std::vector<std::shared_ptr<const void>> unneeded_;
	GroundFigures figures_;
};

} // namespace thicket
