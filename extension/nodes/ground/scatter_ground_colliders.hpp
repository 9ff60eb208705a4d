#pragma once

#include "core/base/rect.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/ground/ground_watch.hpp"
#include "nodes/ground/scatter_ground.hpp"
#include "nodes/ground/tree_walk.hpp"
#include "nodes/ground/voxel_volumes.hpp"

#include <godot_cpp/classes/physics_direct_space_state3d.hpp>
#include <godot_cpp/variant/aabb.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace thicket {

/// Ground from the colliders of the scene, found by rays from above. Rays can only be cast in
/// physics frames, a limited number per frame. If a shape of a static body is added, removed, moved
/// or changed, the ground is updated within about half a second.
class ScatterGroundColliders : public ScatterGround {
	GDCLASS(ScatterGroundColliders, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterGroundColliders";

	bool moves_with_host() const override { return false; }

	bool needs_physics_frames() const override { return true; }
	std::size_t max_positions_per_call() const override { return static_cast<std::size_t>(rays_per_frame_); }
	bool is_available() const override;
	bool has_unapplied_changes() const override { return watch_.has_changes() || !queue_.empty(); }
	GroundFigures figures() const override { return figures_; }

	/// Returns the tolerance of re-checks, including the imprecision of hits, which is proportional
	/// to the ray's length.
	double recheck_tolerance() const override;

	/// Sets the physics layers whose bodies are ground, as a 32-bit mask. Other values print an
	/// error and are ignored.
	void set_collision_mask(int64_t p_mask);
	int64_t get_collision_mask() const;

	/// These setters set the world heights in meters at which rays begin and end, within +-1e6.
	/// They may be called in any order. While the top is not above the bottom, an error is printed
	/// and the ground is unavailable: existing instances stay unchanged.
	void set_ray_top(double p_height);
	double get_ray_top() const;
	void set_ray_bottom(double p_height);
	double get_ray_bottom() const;

	/// Sets the number of rays per physics frame, 1 to 1e6. Other values print an error and are
	/// ignored.
	void set_rays_per_frame(int64_t p_rays);
	int64_t get_rays_per_frame() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	bool only_on_main_thread() override { return true; }
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground) override;
	bool can_change_unreported() const override { return true; }
	Status recheck_for(const GroundHost &host, std::span<const glm::dvec2> positions,
			std::span<std::optional<float>> r_heights) override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;
	void follow() override;

private:
	/// The last reported state of a shape.
	struct ShapeState {
		GroundNodeState state;
		std::optional<godot::AABB> bounds; ///< The bounds in local space; empty if the shape is unbounded.
	};

	Status check() const;
	godot::PhysicsDirectSpaceState3D *space_of(const GroundHost &host) const;
	bool is_in_scene() const;
	GroundWatch::ReadState state_reader() const;
	void start_over();
	void find_next_shapes();
	bool is_ground_shape(const godot::Node *p_node) const;
	std::optional<ShapeState> measure(std::uint64_t id, const ShapeState *before);
	void update_next_shapes();
	void update(std::uint64_t id);
	void add_area(const ShapeState &shape, glm::dvec3 offset);
	void notify();
	void source_changed(int64_t p_source);
	void node_added(godot::Node *p_node);

	int64_t collision_mask_ = 1;
	double ray_top_ = 1000.0;
	double ray_bottom_ = -1000.0;
	int64_t rays_per_frame_ = 250;

	using Offsets = std::map<std::uint64_t, glm::dvec3>; ///< World offsets, keyed by host ID.

	GroundWatch watch_{this, "_source_changed"}; ///< Watches CollisionShape3Ds of static bodies.
	TreeWalk walk_;
	VoxelVolumes volumes_;
	godot::Variant tree_;                        ///< The SceneTree; null until its signal is connected.
	std::map<std::uint64_t, ShapeState> shapes_; ///< The shapes that are ground, by node ID.
	Offsets offsets_;                            ///< The hosts' offsets for `shapes_`.

	// A change passes through the following members in order.
	std::vector<std::uint64_t> queue_; ///< Shapes to re-check.
	Offsets next_offsets_;             ///< The hosts' offsets when the queue was filled.
	std::size_t points_read_ = 0;      ///< The number of shape points that were read in this frame.
	std::vector<Rect> areas_;          ///< Areas of changed ground in world space.
	bool changed_everywhere_ = false;
	GroundFigures figures_;
};

} // namespace thicket
