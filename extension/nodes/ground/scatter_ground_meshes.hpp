#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/common/worker_task.hpp"
#include "nodes/ground/ground_pieces.hpp"
#include "nodes/ground/ground_watch.hpp"
#include "nodes/ground/mesh_parts.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/variant/string_name.hpp>

#include <glm/vec3.hpp>

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

/// Ground from the meshes and collision shapes of a group of nodes (see GroundMembers). The meshes
/// are first read when a node needs the ground. After that, if a node is added, removed, moved or
/// changed, the ground is updated within about half a second. The main thread copies mesh data from
/// the renderer in steps, and a worker builds the ground from the copies. The previous ground
/// remains in use until then.
class ScatterGroundMeshes : public ScatterGround {
	GDCLASS(ScatterGroundMeshes, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundMeshes";

	/// Sets the name of the group in the scene tree of the host. If the name is empty, there is no
	/// ground.
	void set_group(const godot::StringName &p_group);
	godot::StringName get_group() const;

	/// Rereads all meshes synchronously and emits signals where meshes were added, removed, moved
	/// or changed.
	void refresh();

	bool has_unapplied_changes() const override;
	bool is_pending(std::uint64_t host) const override;
	std::vector<Rect> take_removed_areas(std::uint64_t host) override;
	void finish_reading() override;
	GroundFigures figures() const override { return figures_; }
	bool has_surfaces() const override { return true; }
	Planet planet() const override { return planet_; }
	GroundShell shell(std::uint64_t host, const Planet &planet) const override;

	/// Sets the radius of the planet that the meshes form, 0 to max_planet_radius meters. If it is
	/// 0, the ground is not a planet.
	void set_planet_radius(double p_radius);
	double get_planet_radius() const { return planet_.radius; }

	/// Sets the center of the planet, in world meters.
	void set_planet_center(const godot::Vector3 &p_center);
	godot::Vector3 get_planet_center() const;

	static constexpr double max_planet_radius = 1e6;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	godot::String find_remark() override;
	godot::String find_export_problem() override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;
	void follow() override;
	bool start_rereading() override;

private:
	/// A mesh that has just been read for an instance.
	struct FreshCopy {
		std::uint64_t id = 0;
		std::uint64_t version = 0;
		std::shared_ptr<const MeshCopy> copy;
	};
	using Worlds = std::map<std::uint64_t, GroundWorld>; ///< The ground of each host, keyed by host ID.

	bool is_in_scene() const;
	GroundWatch::ReadState state_reader();
	void list_members(bool as_changed);
	void record_removal(std::uint64_t id);
	void start_reading();
	void queue_all();
	void add_worlds();
	void read_next(std::chrono::steady_clock::time_point deadline);
	void plan_next();
	bool plan(std::uint64_t id);
	std::vector<MeshReading> readings_of(std::uint64_t id, const GroundNodeState &state) const;
	GroundNodeState state_in_space(const GroundSpace &space, std::uint64_t id, const GroundNodeState &state) const;
	void read_step();
	bool lacks_ground() const;
	void build(bool synchronously);
	void take_result();
	void take_refusals(const MeshWork &work);
	void reject(std::uint64_t id, const godot::String &p_reason);
	void forget_work();
	void notify(const std::vector<Rect> &areas, bool was_empty);
	bool is_empty() const;
	void source_changed(int64_t p_source);

	godot::StringName group_;
	Planet planet_;
	GroundWatch watch_{this, "_source_changed"};
	GroundMembers members_;
	Worlds worlds_;
	/// The ground of the first host, for callers without a host.
	std::shared_ptr<const TriangleParts> last_ground_;
	bool is_stale_ = true; ///< True if the group must be reread completely.
	/// True from the time the group is listed until all of its ground is built.
	bool is_reading_all_ = false;
	int64_t listed_count_ = 0; ///< The result of GroundMembers::count() when the group was last listed.

	// A change passes through the following members in order.
	std::vector<std::uint64_t> queue_;                         ///< IDs of instances to check and read.
	MeshReader reader_;                                        ///< Reads the mesh of the queue's last instance.
	FreshCopy fresh_copy_;                                     ///< The mesh of that instance once it is read.
	std::vector<MeshReading> readings_;                        ///< Meshes that wait for the builder.
	std::vector<std::uint64_t> removed_ids_;                   ///< IDs of instances that are no longer ground.
	std::map<std::uint64_t, std::vector<Rect>> removed_areas_; ///< See take_removed_areas(). Keyed by host ID.
	WorkerTask<MeshWork> builder_;
	bool is_building_ = false; ///< True unless the builder is idle or only frees memory.

	/// The version and the copy of each mesh, by source ID.
	std::map<std::uint64_t, std::pair<std::uint64_t, std::weak_ptr<const MeshCopy>>> copies_;
	/// The reasons why instances are not ground, by instance ID.
	std::map<std::uint64_t, godot::String> refusals_;
	std::vector<std::shared_ptr<const void>> unneeded_objects_;
	GroundFigures figures_;
};

} // namespace thicket
