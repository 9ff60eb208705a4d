#pragma once

#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/base/world_frame.hpp"
#include "core/terrain/ground_shell.hpp"
#include "core/terrain/terrain.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/scene_use.hpp"
#include "nodes/common/script_answer.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/gdvirtual.gen.inc>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

// In godot-cpp 4.4, GDVIRTUAL0RC and similar macros use these names without a namespace.
using godot::METHOD_FLAG_CONST;
using godot::METHOD_FLAG_VIRTUAL;

/// The maximum absolute value of a ground's height settings, in world meters.
inline constexpr double height_limit = 1e6;

/// A node that uses a ground. The engine's origin may have a different world position for each
/// host.
struct GroundHost {
	godot::Node3D *node = nullptr;
	std::uint64_t id = 0; ///< The node's instance ID.
	/// The world position of the engine's origin in meters: world = engine + offset. Zero for local
	/// coordinates.
	glm::dvec3 offset{0.0};
	bool local = false; ///< True if the world is the node's local space; see WorldFrame.

	/// Returns the frame for ScatterGround::enter and set_world_frame, without the rotation.
	WorldFrame frame() const { return {.offset = offset, .local = local}; }
};

/// Statistics of the work that a ground does to track the scene.
struct GroundFigures {
	std::size_t checks = 0; ///< Nodes checked in the last frame.
	/// Meshes or shapes that were read since the ground was created.
	std::uint64_t reads = 0;
};

/// The ground on which layers are placed. Use one of the derived classes, or extend this class with
/// a script that implements `_get_heights`.
///
/// All public methods may run a script, which may do anything, even release the ground. They keep
/// the ground alive until they return.
class ScatterGround : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterGround, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGround";

	/// Returns an immutable view of the current ground for the host with this ID. Any thread may
	/// use it. Returns null if there is no ground, or if only the main thread may sample it.
	std::shared_ptr<const Terrain> snapshot(std::uint64_t host);

	/// Returns a message that explains why this ground cannot be used; empty if it can.
	godot::String problem();

	/// Returns a warning about a usable ground; empty if there is none.
	godot::String remark();

	/// Returns a message about the script method that caused the error `status`; empty if no script
	/// caused it. Any thread may call this method.
	virtual godot::String script_problem(const Status &status) const { return answers_.sentence(status); }

	/// Returns true if sampling a snapshot calls a script, which may do anything.
	virtual bool calls_script() const { return get_class() == godot::String(class_name); }

	/// Returns true if this is the other ground, or combines it with other grounds.
	virtual bool contains(const ScatterGround *p_other) const { return p_other == this; }

	/// Adds all resources that the main thread reads every frame while a node uses this ground.
	virtual void add_used(SceneUse::List &r_used) { r_used.add(godot::Ref<ScatterGround>(this)); }

	/// Returns a message about a feature that does not work because an export has stripped its
	/// resource; empty if nothing was stripped.
	godot::String export_problem();

	/// Returns true if this ground has texture weights. Otherwise layers that require certain
	/// textures grow everywhere.
	virtual bool has_textures() const;

	/// Returns true if layers can grow on all its surfaces, not only on its top.
	virtual bool has_surfaces() const { return false; }

	/// Returns the planet that the ground forms, in world coordinates. By default, there is none.
	virtual Planet planet() const { return {}; }

	/// Returns a shell around the center of `planet` that contains all ground for the host with
	/// this ID.
	virtual GroundShell shell(std::uint64_t /*host*/, const Planet & /*planet*/) const {
		return GroundShell::everywhere();
	}

	/// Returns true if the ground may only be sampled on the main thread, with `sample_now`.
	bool is_main_thread_only();

	/// Returns true if `sample_now` may only be called in physics frames.
	virtual bool needs_physics_frames() const { return false; }

	/// Returns the maximum number of positions per call to `sample_now` and per physics frame.
	virtual std::size_t max_positions_per_call() const;

	/// Returns false while the source of the ground is temporarily missing. Tiles stay unchanged
	/// during that time.
	virtual bool is_available() const { return true; }

	/// Samples the ground data in `needs` at world `positions`, for the host with this ID, on the
	/// main thread. `r_ground` must have the size of `positions`. A NAN height means that there is
	/// no ground. Returns an error if a script returns the wrong number of heights, normals or
	/// weights.
	Status sample_now(std::uint64_t host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	/// Returns true if tiles on this ground must be re-checked, because it can change without a
	/// signal and the user has not disabled re-checks.
	bool rechecks() const { return recheck_enabled_ && can_change_unreported(); }
	void set_recheck_enabled(bool p_enabled) { recheck_enabled_ = p_enabled; }
	bool is_recheck_enabled() const { return recheck_enabled_; }

	/// Samples heights for re-checks, under the same conditions as `sample_now`. A height is NAN if
	/// there is no ground, and empty if the ground is currently unknown.
	Status recheck_now(
			std::uint64_t host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);

	/// Returns the tolerance of re-checks in meters. Smaller changes in height are ignored, because
	/// they do not justify regenerating tiles.
	virtual double recheck_tolerance() const { return 0.01; }

	/// Registers and unregisters a node in the tree that uses this ground. Each `enter` needs a
	/// `leave` before the node is freed. Main thread only, as is `set_world_frame`.
	void enter(godot::Node3D *p_host, const WorldFrame &frame);
	void leave(godot::Node3D *p_host);

	/// Call this after a host's game has recentered its world, and while a host with local
	/// coordinates moves. Ground from scene nodes has then moved with the scene, while all other
	/// ground stays fixed in the world.
	void set_world_frame(const godot::Node3D *p_host, const WorldFrame &frame);

	/// Returns true if the ground moves with a host that has local coordinates.
	virtual bool moves_with_host() const { return true; }

	/// Makes ground that caches its source search for it again. Call it when the ground may have
	/// changed without a signal.
	virtual void search_again() {}

	/// Checks ground from scene nodes for changes and emits signals for them. Call it in every
	/// frame of every host. Does at least one step of work per frame and starts no more steps after
	/// `deadline`.
	void follow_scene(std::chrono::steady_clock::time_point deadline);

	/// Returns true while known changes have not been applied to the ground yet.
	virtual bool has_unapplied_changes() const { return false; }

	/// Returns true while new ground is being read, so that `snapshot` returns null or the previous
	/// ground. After that, the ground may have changed everywhere.
	virtual bool is_pending(std::uint64_t /*host*/) const { return false; }

	/// Returns the areas in which ground for the host with this ID has disappeared since the last
	/// call. The ground may not have been rebuilt without it yet.
	virtual std::vector<Rect> take_removed_areas(std::uint64_t /*host*/) { return {}; }

	/// Finishes reading the ground synchronously. Emits signals.
	virtual void finish_reading() {}

	virtual GroundFigures figures() const { return {}; }

	/// Starts rereading all ground over the next frames, which emits signals where it has changed.
	/// Returns false if this ground cannot do that; the caller must then assume that it has changed
	/// everywhere.
	bool reread();

	/// Returns the ground height in meters at the x and z of a world position; NAN if there is no
	/// ground.
	double get_height(const godot::Vector3 &p_global_position);

	/// Returns the unit normal of the ground at the x and z of a world position; zero if there is
	/// no ground.
	godot::Vector3 get_normal(const godot::Vector3 &p_global_position);

	GDVIRTUAL1RC(godot::PackedFloat32Array, _get_heights, godot::PackedVector2Array)
	GDVIRTUAL1RC(godot::PackedVector3Array, _get_normals, godot::PackedVector2Array)
	GDVIRTUAL2RC(godot::PackedFloat32Array, _get_weights, godot::PackedVector2Array, godot::PackedInt32Array)
	GDVIRTUAL0RC(bool, _is_thread_safe)

protected:
	static void _bind_methods();

	/// These methods implement the public methods with similar names. The versions of this class
	/// call a script's methods.
	virtual std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host);
	virtual godot::String find_problem();
	virtual godot::String find_remark() { return {}; }
	virtual godot::String find_export_problem() { return {}; }
	virtual bool only_on_main_thread();
	virtual Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	virtual bool can_change_unreported() const;
	virtual Status recheck_for(
			const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);
	void _validate_property(godot::PropertyInfo &p_property) const;

	/// Reacts to a host that was added or removed. `first` is true if the first host has changed.
	virtual void hosts_changed(bool /*first*/) {}

	/// Does the work of `follow_scene`, at most once per frame.
	virtual void follow() {}
	/// Starts rereading all ground for `reread`. Returns false if this ground cannot do that.
	virtual bool start_rereading() { return false; }

	/// Returns true if hosts move relative to each other, so that each must be notified when a host
	/// with local coordinates moves.
	virtual bool is_shared() const { return hosts_.size() > 1; }

	/// Called after a host's offset has changed, or after a host with local coordinates has moved
	/// relative to other hosts.
	virtual void offset_changed(const GroundHost &) {}

	/// Returns the time at which `follow` must end its work for this frame.
	std::chrono::steady_clock::time_point deadline() const { return deadline_; }

	/// Returns all nodes that use the ground. Node paths, and searches in the scene, start at the
	/// first one.
	std::span<const GroundHost> hosts() const { return hosts_; }

	/// Returns the node of the first host; null if there is none.
	godot::Node3D *first_node() const { return hosts_.empty() ? nullptr : hosts_.front().node; }

	/// Makes the editor update the configuration warnings of all hosts (deferred).
	void update_warnings();

	/// Emits `ground_changed` for a rectangle of the world's x and z, in meters.
	void emit_ground_changed(const godot::Rect2 &p_rect);

private:
	friend class ScriptGround;

	GroundHost find_host(std::uint64_t id) const;
	// These methods call a script. They request normals and weights only where there is ground, at
	// the positions that `indices` selects.
	Status query_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground);
	Status query_slopes(std::span<const glm::dvec2> positions, std::span<Ground> r_ground);
	Status query_weights(
			std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures, std::span<Ground> r_ground);
	Status query_normals(
			std::span<const glm::dvec2> positions, std::span<const std::size_t> indices, std::span<Ground> r_ground);
	Status difference_normals(
			std::span<const glm::dvec2> positions, std::span<const std::size_t> indices, std::span<Ground> r_ground);
	Ground ground_at(const godot::Vector3 &p_global_position, bool normal);

	ScriptAnswers answers_;
	bool recheck_enabled_ = true;
	std::vector<GroundHost> hosts_;
	std::chrono::steady_clock::time_point deadline_;
	std::uint64_t followed_frame_ = ~std::uint64_t{0}; ///< The process frame of the last `follow`.
};

/// A ground, as seen by one of its hosts.
struct HostedGround {
	godot::Ref<ScatterGround> ground;
	std::uint64_t host = 0;

	/// Returns true if there is a ground that can currently be sampled.
	bool is_available() const { return ground.is_valid() && ground->is_available(); }

	/// Samples the ground; see ScatterGround::sample_now. `ground` must not be null.
	Status sample_now(
			std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		const godot::Ref<ScatterGround> keep_alive = ground; // A script may destroy this object.
		return keep_alive->sample_now(host, positions, needs, r_ground);
	}
};

} // namespace thicket
