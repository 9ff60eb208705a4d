#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

namespace thicket {

/// The colliders of the scene, hit by rays from above. Rays may be cast in physics frames only, so many a frame.
class ScatterTerrainColliders : public ScatterTerrain {
	GDCLASS(ScatterTerrainColliders, ScatterTerrain)
	THICKET_GUARDED_METHODS

public:
	bool needs_physics_frames() const override { return true; }
	std::size_t max_positions_per_call() const override { return static_cast<std::size_t>(rays_per_frame_); }
	bool is_available() const override;

	/// Physics layers whose bodies are ground, a bit each, 32 bits. Anything else prints an error and is ignored.
	void set_collision_mask(int64_t p_mask);
	int64_t get_collision_mask() const;

	/// World meters from where, and down to where, each ray goes; +-1e6, the top above the bottom. May be set in any
	/// order: while they are inverted, one error says so, and what stands stays.
	void set_ray_top(double p_height);
	double get_ray_top() const;
	void set_ray_bottom(double p_height);
	double get_ray_bottom() const;

	/// Rays in a physics frame, 1 to 1e6. Anything else prints an error and is ignored.
	void set_rays_per_frame(int64_t p_rays);
	int64_t get_rays_per_frame() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	bool only_on_main_thread() override { return true; }
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
			std::span<const std::int32_t> textures, std::span<Ground> r_ground) override;

private:
	Status check() const;

	int64_t collision_mask_ = 1;
	double ray_top_ = 1000.0;
	double ray_bottom_ = -1000.0;
	int64_t rays_per_frame_ = 250;
};

} // namespace thicket
