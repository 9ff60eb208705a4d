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

// In godot-cpp 4.4, GDVIRTUAL0RC and similar macros use these names without a namespace.
using godot::METHOD_FLAG_CONST;
using godot::METHOD_FLAG_VIRTUAL;

inline constexpr double height_limit = 1e6; ///< World meters up and down: the limit of a ground's settings.

/// A node that uses a ground. Its scene is in the engine's space, which may be at a different world position for each
/// node.
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

/// The ground that layers are placed on. Extend it by a script with `_get_heights`, or use one of the built-in kinds.
///
/// All public methods may run a script, which may do anything, even release the ground: the methods keep it alive until they return.
class ScatterGround : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterGround, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGround";

	/// An immutable view of the current ground for the host with this ID. Any thread may use it while it exists. Null
	/// if there is no ground, or if only the main thread may sample the ground.
	std::shared_ptr<const Terrain> snapshot(std::uint64_t host);

	/// The reason why this ground cannot be used, in one sentence; empty if there is none.
	godot::String problem();

	/// A remark about a usable ground, in one sentence; empty if there is none.
	godot::String remark();

	/// A sentence about the script method that has caused the error `status`; empty if no method has caused it. Any
	/// thread.
	godot::String script_problem(const Status &status) const { return answers_.sentence(status); }

	/// The feature that cannot work because an export has stripped its resource, in one sentence; empty if nothing was stripped.
	godot::String stripped();

	/// False if this ground does not distinguish textures. Layers that require certain textures then grow everywhere.
	virtual bool has_textures() const;

	/// True if the ground may only be sampled on the main thread, by `sample_now`.
	bool is_main_thread_only();

	/// True if `sample_now` may be called in physics frames only.
	virtual bool needs_physics_frames() const { return false; }

	/// The largest number of positions in one call of `sample_now`, and also in one physics frame.
	virtual std::size_t max_positions_per_call() const;

	/// False while the source of the ground is temporarily missing. Tiles then stay unchanged.
	virtual bool is_available() const { return true; }

	/// Samples the ground data in `needs` at `positions` in the world of the host with this ID, on the main thread.
	/// `r_ground` must have the size of `positions`. A script's result is refused if its number of heights, normals or
	/// weights is wrong. NAN heights mean that there is no ground.
	Status sample_now(std::uint64_t host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	/// True if this ground can change without a report and the user has not turned off re-checks. Tiles on it are then
	/// re-checked.
	bool rechecks() const { return recheck_enabled_ && can_change_unreported(); }
	void set_recheck_enabled(bool p_enabled) { recheck_enabled_ = p_enabled; }
	bool is_recheck_enabled() const { return recheck_enabled_; }

	/// Samples heights for re-checks, on the main thread, whenever `sample_now` may be called. NAN if there is no
	/// ground, empty if the ground cannot be read at present.
	Status recheck_now(
			std::uint64_t host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);

	/// The difference in meters between two heights of a re-check up to which the ground counts as unchanged, because a
	/// new tile is not worth a smaller difference.
	virtual double recheck_tolerance() const { return 0.01; }

	/// Registers and removes a node in the tree that uses this ground. Each `enter` needs a `leave` while the node
	/// still exists. Main thread only, as is `set_world_offset`.
	void enter(godot::Node3D *p_host, glm::dvec3 offset);
	void leave(godot::Node3D *p_host);

	/// Call this after the game of a node that uses this ground has recentered. Ground that is part of the scene has
	/// moved with the scene; all other ground is fixed in the world.
	void set_world_offset(const godot::Node3D *p_host, glm::dvec3 offset);

	/// The ground may have changed since it was found, without a report.
	virtual void look_again() {}

	/// Call this in every frame of a host. Ground that is part of the scene checks whether it has changed, and reports
	/// changes. Does at least one step of its work in each frame, and begins no further step after `deadline`.
	void follow_scene(std::chrono::steady_clock::time_point deadline);

	/// True while the ground does not yet include known changes in the scene.
	virtual bool is_behind() const { return false; }

	/// True while new ground is still being read, so that `snapshot` returns null or the previous ground. Once the new
	/// ground is read, everything may have changed.
	virtual bool is_pending(std::uint64_t /*host*/) const { return false; }

	/// Reads the ground to the end, for a caller that cannot wait for a later frame. Emits signals.
	virtual void finish_reading() {}

	virtual GroundFigures figures() const { return {}; }

	/// Rereads all ground, in portions, and reports where it has changed. Returns false if this ground cannot report
	/// that. Any part of it may then have changed.
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

	/// Implementations of the public methods of the same names. These versions call a script's methods.
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

	/// Called after a host was added or removed. `first` is true if a different host is now the first one.
	virtual void hosts_changed(bool /*first*/) {}

	/// Implementations of the public methods, called at most once per frame.
	virtual void follow() {}
	virtual bool distrust() { return false; }

	/// Called after the offset of a host has changed.
	virtual void offset_changed(const GroundHost &) {}

	/// The time at which `follow` must end its work in this frame.
	std::chrono::steady_clock::time_point deadline() const { return deadline_; }

	/// All nodes that use the ground. Searches for nodes in the scene start at the first one.
	std::span<const GroundHost> hosts() const { return hosts_; }

	/// The node of the first host; null if there is none.
	godot::Node3D *first_node() const { return hosts_.empty() ? nullptr : hosts_.front().node; }

	/// Makes the editor query the problems of all hosts again, soon.
	void update_warnings();

	/// Emits the signal that the ground has changed within a world rect, in meters of x and z.
	void emit_ground_changed(const godot::Rect2 &p_rect);

private:
	friend class ScriptGround;

	GroundHost find_host(std::uint64_t id) const;
	// Calls a script's methods. `found` contains the indices of the positions that have ground; normals and weights are
	// only requested for these.
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
