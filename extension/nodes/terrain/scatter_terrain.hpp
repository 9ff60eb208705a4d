#pragma once

#include "core/terrain/terrain.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/gdvirtual.gen.inc>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

inline constexpr double height_limit = 1e6; ///< World meters up and down: as far as the settings of a terrain go.

/// The ground that layers stand on. Extend it in a script by `_get_heights`, or use one of the shipped kinds.
class ScatterTerrain : public godot::Resource {
	GDCLASS(ScatterTerrain, godot::Resource)

public:
	/// An immutable view of the ground as it is now, safe on any thread for as long as it is held. Null when there is
	/// no ground to give, or when it may only be asked on the main thread.
	virtual std::shared_ptr<const Terrain> snapshot();

	/// What keeps this ground from being used, in one sentence; empty when nothing does.
	virtual godot::String problem();

	/// False when this ground tells no textures apart, so that layers which ask for some stand everywhere.
	virtual bool has_textures() const;

	/// True when the ground may only be asked on the main thread, by `ask`.
	virtual bool main_thread_only() const;

	/// True when `ask` may be called in physics frames only.
	virtual bool needs_physics_frames() const { return false; }

	/// The most places to ask for in one call of `ask`, and in one physics frame.
	virtual std::size_t places_at_once() const;

	/// False while that which gives the ground is away for the time being: tiles are then left as they are.
	virtual bool ready() const { return true; }

	/// On the main thread: the ground under `positions`, and how much of it belongs to `textures` (see Terrain::weigh;
	/// none: not asked for). `r_ground` has the size of `positions`. A script that gives a wrong number of heights,
	/// normals or weights is refused; its NAN heights stand for no ground.
	virtual Status ask(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const;

	/// Asks a script for the weights alone; where it has no method for them they stay.
	Status ask_weights(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const;

	/// A node in the tree that begins to use this ground, or no longer does. Each `enter` has its `leave`, while the
	/// node is still there.
	void enter(godot::Node3D *p_host);
	void leave(godot::Node3D *p_host);

	/// Where the engine's origin is in the world, meters: world = engine + offset. Counts for ground that is found in the scene,
	/// which moves along when a game recenters; all other ground is the world's. Main thread only.
	void set_world_offset(glm::dvec3 offset);

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

	/// Called after the first of the hosts has become another one.
	virtual void host_changed() {}

	/// Called after `world_offset` has become another one.
	virtual void offset_changed() {}
	glm::dvec3 world_offset() const { return world_offset_; }

	/// The node from which what this ground needs of the scene is looked for: the first of those that use it; null for
	/// none.
	godot::Node3D *host() const { return hosts_.empty() ? nullptr : hosts_.front(); }

	/// Tells that the ground has changed within a world rect, in meters of x and z.
	void emit_terrain_changed(const godot::Rect2 &p_rect);

private:
	Status ask_normals(const godot::PackedVector2Array &p_positions, std::span<Ground> r_ground) const;
	Status difference_normals(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	Ground ground_at(const godot::Vector3 &p_global_position);

	std::vector<godot::Node3D *> hosts_;
	glm::dvec3 world_offset_{0.0};
};

} // namespace thicket
