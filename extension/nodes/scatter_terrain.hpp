#pragma once

#include "core/terrain/terrain.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/gdvirtual.gen.inc>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <memory>
#include <span>

namespace thicket {

/// The ground that layers stand on. Extend it in a script by `_get_heights`, or use one of the shipped kinds.
class ScatterTerrain : public godot::Resource {
	GDCLASS(ScatterTerrain, godot::Resource)

public:
	/// An immutable view of the ground as it is now, safe on any thread for as long as it is held. Null when there is
	/// no ground to give, or when a script gives it and may only be asked on the main thread.
	virtual std::shared_ptr<const Terrain> snapshot();

	/// What keeps this ground from being used, in one sentence; empty when nothing does.
	virtual godot::String problem();

	/// True when the ground comes from a script that may only be asked on the main thread, by `ask_script`.
	bool main_thread_only() const;

	/// Asks the script for the ground under `positions`; `r_ground` has the same size. A script that gives a wrong
	/// number of heights or normals is refused; its NAN heights stand for no ground.
	Status ask_script(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;

	/// Height in metres of the ground above or below a world position; NAN where there is none.
	double get_height(const godot::Vector3 &p_global_position);

	/// Unit normal of the ground there; zero where there is none.
	godot::Vector3 get_normal(const godot::Vector3 &p_global_position);

	GDVIRTUAL1RC(godot::PackedFloat32Array, _get_heights, godot::PackedVector2Array)
	GDVIRTUAL1RC(godot::PackedVector3Array, _get_normals, godot::PackedVector2Array)
	GDVIRTUAL0RC(bool, _is_thread_safe)

protected:
	static void _bind_methods();

private:
	Status ask_normals(const godot::PackedVector2Array &p_positions, std::span<Ground> r_ground) const;
	Status difference_normals(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const;
	Ground ground_at(const godot::Vector3 &p_global_position);
};

} // namespace thicket
