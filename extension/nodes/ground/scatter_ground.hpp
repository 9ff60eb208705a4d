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

inline constexpr double height_limit = 1e6; ///< World meters up and down: as far as the settings of a terrain go.

/// A node that uses a ground. What stands in the scene stands in the engine's space, which each node may see at another position of
/// the world.
struct GroundHost {
	godot::Node3D *node = nullptr;
	std::uint64_t id = 0;   ///< Of the node as an object of the engine.
	glm::dvec3 offset{0.0}; ///< Where the engine's origin is in the world, in meters: world = engine + offset.
};

/// How much a ground does to follow the scene.
struct GroundFigures {
	std::size_t checks = 0;  ///< Nodes that were looked at in the last frame.
	std::uint64_t reads = 0; ///< Meshes or shapes that were read since the ground was made.
};

/// The ground that layers stand on. Extend it in a script by `_get_heights`, or use one of the shipped kinds.
///
/// All public methods may run a script, which may do anything, even let go of the terrain: they keep it until they return.
class ScatterGround : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterGround, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// An immutable view of the ground as it is now, for the host of this id, safe on any thread for as long as it is held.
	/// Null when there is no ground to give, or when it may only be asked on the main thread.
	std::shared_ptr<const Terrain> snapshot(std::uint64_t host);

	/// What keeps this ground from being used, in one sentence; empty when nothing does.
	godot::String problem();

	/// What should be known of a ground that can be used, in one sentence; empty for nothing.
	godot::String remark();

	/// A sentence about the method of a script that has caused the error `status`; empty if none has. Any thread.
	godot::String script_problem(const Status &status) const { return answers_.sentence(status); }

	/// What cannot work because an export has stripped it; empty if nothing was.
	godot::String stripped();

	/// False when this ground tells no textures apart, so that layers which ask for some stand everywhere.
	virtual bool has_textures() const;

	/// True when the ground may only be asked on the main thread, by `sample_now`.
	bool is_main_thread_only();

	/// True when `sample_now` may be called in physics frames only.
	virtual bool needs_physics_frames() const { return false; }

	/// The most positions to ask for in one call of `sample_now`, and in one physics frame.
	virtual std::size_t max_positions_per_call() const;

	/// False while that which gives the ground is away for the time being: tiles are then left as they are.
	virtual bool is_available() const { return true; }

	/// On the main thread: the parts that `needs` names of the ground under `positions` in the world of the host of this id. `r_ground` has the
	/// size of `positions`. A script that gives a wrong number of heights, normals or weights is refused; its NAN heights stand for no ground.
	Status sample_now(std::uint64_t host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground);

	/// Whether this ground can change without a report, so that what was made on it is re-checked; false where the user has turned it off.
	bool rechecks() const { return recheck_enabled_ && can_change_unreported(); }
	void set_recheck_enabled(bool p_enabled) { recheck_enabled_ = p_enabled; }
	bool is_recheck_enabled() const { return recheck_enabled_; }

	/// On the main thread, at the times of `sample_now`: heights for re-checks, NAN for no ground, none where it cannot be read at present.
	Status recheck_now(
			std::uint64_t host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights);

	/// Meters by which heights of unchanged ground may differ. So little is not worth a new tile.
	virtual double recheck_tolerance() const { return 0.01; }

	/// A node in the tree begins to use this ground, or no longer does. Each `enter` has its `leave`, while the node is still
	/// there. Main thread only, as is the next.
	void enter(godot::Node3D *p_host, glm::dvec3 offset);
	void leave(godot::Node3D *p_host);

	/// The game of a node that uses this ground has recentered. Counts for ground that is found in the scene, which moves along;
	/// all other ground is the world's.
	void set_world_offset(const godot::Node3D *p_host, glm::dvec3 offset);

	/// The ground may be another one than it was found to be, and nothing has told so.
	virtual void look_again() {}

	/// To be called in every frame of a host: ground that is found in the scene looks whether it is as it was, and tells what is not.
	/// It takes up no new step of its work after `deadline`, but does one in each frame.
	void follow_scene(std::chrono::steady_clock::time_point deadline);

	/// True while something is known to have changed in the scene that the ground does not show yet.
	virtual bool is_behind() const { return false; }

	/// True while `snapshot` does not yet give a host the ground that was set, because it is still being read: it gives none, or the one
	/// before. Everything may have changed when it does.
	virtual bool is_pending(std::uint64_t /*host*/) const { return false; }

	/// Ends that, for a caller who cannot wait for a later frame. Emits signals.
	virtual void finish_reading() {}

	virtual GroundFigures figures() const { return {}; }

	/// Looks at all ground anew, in portions, and tells where it is not as it was. False for ground that cannot tell: anything may
	/// be another.
	bool read_again();

	/// Height in meters of the ground above or below a world position; NAN where there is none.
	double get_height(const godot::Vector3 &p_global_position);

	/// Unit normal of the ground there; zero where there is none.
	godot::Vector3 get_normal(const godot::Vector3 &p_global_position);

	GDVIRTUAL1RC(godot::PackedFloat32Array, _get_heights, godot::PackedVector2Array)
	GDVIRTUAL1RC(godot::PackedVector3Array, _get_normals, godot::PackedVector2Array)
	GDVIRTUAL2RC(godot::PackedFloat32Array, _get_weights, godot::PackedVector2Array, godot::PackedInt32Array)
	GDVIRTUAL0RC(bool, _is_thread_safe)

protected:
	static void _bind_methods();

	/// What the public methods of these names do. A script's are asked here.
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

	/// Called after a host has come or gone. `first`: another one is the first now.
	virtual void hosts_changed(bool /*first*/) {}

	/// What the public methods do, at most once a frame.
	virtual void follow() {}
	virtual bool distrust() { return false; }

	/// Called after the offset of a host has become another one.
	virtual void offset_changed(const GroundHost &) {}

	/// When the work of `follow` is over for this frame.
	std::chrono::steady_clock::time_point deadline() const { return deadline_; }

	/// All that use the ground. What it needs of the scene is looked for from the first of them.
	std::span<const GroundHost> hosts() const { return hosts_; }

	/// The node of the first host; null for none.
	godot::Node3D *first_node() const { return hosts_.empty() ? nullptr : hosts_.front().node; }

	/// The editor asks all hosts for their problems again, soon.
	void update_warnings();

	/// Tells that the ground has changed within a world rect, in meters of x and z.
	void emit_ground_changed(const godot::Rect2 &p_rect);

private:
	friend class ScriptGround;

	GroundHost find_host(std::uint64_t id) const;
	// Calls of a script. `found`: indices of positions with ground; normals and weights are requested for these alone.
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

/// A ground as one of its hosts uses it.
struct HostedGround {
	godot::Ref<ScatterGround> ground;
	std::uint64_t host = 0;

	/// True if there is a ground that can be asked at present.
	bool is_available() const { return ground.is_valid() && ground->is_available(); }

	/// See ScatterGround. Not for a null `ground`.
	Status sample_now(
			std::span<const glm::dvec2> positions, const GroundNeeds &needs, std::span<Ground> r_ground) const {
		const godot::Ref<ScatterGround> held = ground; // A script may delete this object.
		return held->sample_now(host, positions, needs, r_ground);
	}
};

} // namespace thicket
