#pragma once

#include "core/terrain/terrain.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/ground/script_answer.hpp"

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

// GDVIRTUAL0RC and its kin name these without a namespace in godot-cpp 4.4.
using godot::METHOD_FLAG_CONST;
using godot::METHOD_FLAG_VIRTUAL;

inline constexpr double height_limit = 1e6; ///< World meters up and down: the limit of a ground's settings.

/// A node that uses a ground. The scene is in the engine's space, which may be at a different world position for each node.
struct GroundHost {
	godot::Node3D *node = nullptr;
	std::uint64_t id = 0;   ///< The node's object ID in the engine.
	glm::dvec3 offset{0.0}; ///< The world position of the engine's origin, in meters: world = engine + offset.
};

/// The amount of work that a ground does to follow the scene.
struct GroundFigures {
	std::size_t checks = 0;  ///< Nodes that were checked in the last frame.
	std::uint64_t reads = 0; ///< Meshes or shapes that were read since the ground was created.
};

/// The ground that layers are placed on. Extend it in a script by `_get_heights`, or use one of the built-in kinds.
///
/// All public methods may run a script, which may do anything, even release the ground: the methods keep it alive until they return.
class ScatterGround : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterGround, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGround";

	/// An immutable view of the current ground for the host with this ID, safe on any thread for as long as it is held. Null if there is no
	/// ground, or if it may only be sampled on the main thread.
	std::shared_ptr<const Terrain> snapshot(std::uint64_t host);

	/// The reason why this ground cannot be used, in one sentence; empty if there is none.
	godot::String problem();

	/// A remark about a usable ground, in one sentence; empty if there is none.
	godot::String remark();

	/// A sentence about the script method that has caused the error `status`; empty if none has. Any thread.
	godot::String script_problem(const Status &status) const { return answers_.sentence(status); }

	/// The feature that cannot work because an export has stripped its resource, in one sentence; empty if nothing was stripped.
	godot::String stripped();

	/// False if this ground does not distinguish textures, so that layers that require some grow everywhere.
	virtual bool has_textures() const;

	/// True if the ground may only be sampled on the main thread, by `sample_now`.
	bool is_main_thread_only();

	/// True if `sample_now` may be called in physics frames only.
	virtual bool needs_physics_frames() const { return false; }

	/// The largest number of positions in one call of `sample_now`, and in one physics frame.
	virtual std::size_t max_positions_per_call() const;

	/// False while the source of the ground is temporarily missing: tiles then stay unchanged.
	virtual bool is_available() const { return true; }

	/// On the main thread: samples the ground data in `needs` at `positions` in the world of the host with this ID. `r_ground` has the size
	/// of `positions`. A script that returns a wrong number of heights, normals or weights is refused; its NAN heights mean no ground.
	Status sample_now(std::uint64_t host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	/// Whether this ground can change without a report, so that tiles on it are re-checked. False if the user has turned that off.
	bool rechecks() const { return recheck_enabled_ && can_change_unreported(); }
	void set_recheck_enabled(bool p_enabled) { recheck_enabled_ = p_enabled; }
	bool is_recheck_enabled() const { return recheck_enabled_; }

	/// On the main thread, at the times of `sample_now`: heights for re-checks. NAN if there is no ground, empty if it cannot be read at
	/// present.
	Status recheck_now(
			std::uint64_t host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);

	/// Meters by which heights of unchanged ground may differ. Smaller differences are not worth a new tile.
	virtual double recheck_tolerance() const { return 0.01; }

	/// A node in the tree begins or stops to use this ground. Each `enter` has its `leave`, which is called while the node still exists.
	/// Main thread only, as is the next.
	void enter(godot::Node3D *p_host, glm::dvec3 offset);
	void leave(godot::Node3D *p_host);

	/// The game of a node that uses this ground has recentered. Affects ground that is part of the scene, which moves along; all other
	/// ground is fixed in the world.
	void set_world_offset(const godot::Node3D *p_host, glm::dvec3 offset);

	/// The ground may have changed since it was found, without a report.
	virtual void look_again() {}

	/// Call this in every frame of a host. Ground that is part of the scene checks whether it has changed, and reports changes. It begins
	/// no new step of its work after `deadline`, but does one step in each frame.
	void follow_scene(std::chrono::steady_clock::time_point deadline);

	/// True while changes in the scene are known that the ground does not include yet.
	virtual bool is_behind() const { return false; }

	/// True while `snapshot` does not yet return the ground that was set, because it is still being read: it returns null, or the previous
	/// one. Once the ground is read, everything may have changed.
	virtual bool is_pending(std::uint64_t /*host*/) const { return false; }

	/// Finishes the reading, for a caller that cannot wait for a later frame. Emits signals.
	virtual void finish_reading() {}

	virtual GroundFigures figures() const { return {}; }

	/// Rereads all ground, in portions, and reports where it has changed. False for ground that cannot report that: any of it may have
	/// changed.
	bool read_again();

	/// The height in meters of the ground above or below a world position; NAN if there is none.
	double get_height(const godot::Vector3 &p_global_position);

	/// The unit normal of the ground there; zero if there is none.
	godot::Vector3 get_normal(const godot::Vector3 &p_global_position);

	GDVIRTUAL1RC(godot::PackedFloat32Array, _get_heights, godot::PackedVector2Array)
	GDVIRTUAL1RC(godot::PackedVector3Array, _get_normals, godot::PackedVector2Array)
	GDVIRTUAL2RC(godot::PackedFloat32Array, _get_weights, godot::PackedVector2Array, godot::PackedInt32Array)
	GDVIRTUAL0RC(bool, _is_thread_safe)

protected:
	static void _bind_methods();

	/// Implementations of the public methods of these names. These versions call a script's methods.
	virtual std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host);
	virtual godot::String find_problem();
	virtual godot::String find_remark() { return {}; }
	virtual godot::String find_stripped() { return {}; }
	virtual bool only_on_main_thread();
	virtual Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	virtual bool can_change_unreported() const;
	virtual Status recheck_for(
			const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);
	void _validate_property(godot::PropertyInfo &p_property) const;

	/// Called after a host was added or removed. `first` is true if the first host has changed.
	virtual void hosts_changed(bool /*first*/) {}

	/// Implementations of the public methods, called at most once per frame.
	virtual void follow() {}
	virtual bool distrust() { return false; }

	/// Called after the offset of a host has changed.
	virtual void offset_changed(const GroundHost &) {}

	/// The time at which `follow` must end its work in this frame.
	std::chrono::steady_clock::time_point deadline() const { return deadline_; }

	/// All nodes that use the ground. The first of them is the starting point for finding nodes in the scene.
	std::span<const GroundHost> hosts() const { return hosts_; }

	/// The node of the first host; null if there is none.
	godot::Node3D *first_node() const { return hosts_.empty() ? nullptr : hosts_.front().node; }

	/// Makes the editor query the problems of all hosts again, soon.
	void update_warnings();

	/// Emits that the ground has changed within a world rect, in meters of x and z.
	void emit_ground_changed(const godot::Rect2 &p_rect);

private:
	friend class ScriptGround;

	GroundHost find_host(std::uint64_t id) const;
	// Calls of a script. `found` contains the indices of positions with ground; normals and weights are requested for these alone.
	Status ask_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground);
	Status ask_slopes(std::span<const glm::dvec2> positions, std::span<Ground> r_ground);
	Status ask_weights(
			std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures, std::span<Ground> r_ground);
	Status ask_normals(
			std::span<const glm::dvec2> positions, std::span<const std::size_t> found, std::span<Ground> r_ground);
	Status difference_normals(
			std::span<const glm::dvec2> positions, std::span<const std::size_t> found, std::span<Ground> r_ground);
	Ground ground_at(const godot::Vector3 &p_global_position, bool normal);

	ScriptAnswers answers_;
	bool recheck_enabled_ = true;
	std::vector<GroundHost> hosts_;
	std::chrono::steady_clock::time_point deadline_;
	std::uint64_t followed_frame_ = ~std::uint64_t{0}; ///< The engine's frame of the last `follow`.
};

/// A ground as used by one of its hosts.
struct HostedGround {
	godot::Ref<ScatterGround> ground;
	std::uint64_t host = 0;

	/// True if there is a ground that can be sampled at present.
	bool is_available() const { return ground.is_valid() && ground->is_available(); }

	/// See ScatterGround. Not for a null `ground`.
	Status sample_now(
			std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		const godot::Ref<ScatterGround> held = ground; // A script may delete this object.
		return held->sample_now(host, positions, needs, r_ground);
	}
};

} // namespace thicket
