#pragma once

#include "core/terrain/weight_map.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A copy of an HTerrain-like square map without its heights: its transform, holes and painted
/// textures. The map is upright: it may be moved and scaled, but only rotated about the vertical
/// axis. Any thread may use the copy.
struct TerrainMap {
	/// The transform from map space, whose unit in x and z is the distance between height samples,
	/// to the engine's space.
	godot::Transform3D to_world;
	double last_post = 0.0; ///< The map extends from 0 to this value in x and z.
	/// Holes are where the fourth channel is below one half. Empty if there are no holes.
	WeightMap colors;
	/// The weights of the painted textures, four textures per map. If empty, all textures have a
	/// weight of 1 everywhere.
	std::vector<WeightMap> splats;

	/// Returns true if TerrainMap contains maps of the kind with this HTerrain ID. Returns false
	/// for heights.
	static bool copies(std::int64_t map);

	/// Transforms a position of the engine's x and z to map space.
	glm::dvec2 to_map(glm::dvec2 world) const;
	/// Transforms a height of the map to the engine's space, in meters.
	float height_in_world(double height) const;
	/// Returns true if a position in map space is on the map and not in a hole.
	bool has_ground(glm::dvec2 position) const;
	/// Returns, for each splat map, a bit mask of the channels of `textures`.
	std::vector<unsigned> channels_of(std::span<const std::int32_t> textures) const;
	/// Returns the total weight of these channels at a position in map space, at most 1.
	float weight(glm::dvec2 position, std::span<const unsigned> channels) const;
	/// Returns the bounding rectangle of a part of the map in the engine's x and z. `p_rect` is in
	/// map space.
	godot::Rect2 world_rect(const godot::Rect2 &p_rect) const;
};

// A script may implement an object's methods and may even free the object. Objects are therefore
// stored in a Variant, which detects freed objects and keeps reference-counted ones alive.

/// Returns true if an object has a method. Returns false if the value is not an object or the
/// object was freed.
bool has_method(const godot::Variant &p_object, const godot::StringName &p_method);

/// Calls a method and returns its result; null if it cannot be called. May run scripts.
godot::Variant result_of(const godot::Variant &p_object, const godot::StringName &p_method,
		std::initializer_list<godot::Variant> p_arguments = {});

/// Returns true for integers and floats.
bool is_number(const godot::Variant &p_value);

/// Reads the map of an HTerrain-like node with the data object `p_data`. Returns null if the
/// transform or size is missing. May run scripts.
std::shared_ptr<const TerrainMap> read_map(const godot::Variant &p_node, const godot::Variant &p_data);

} // namespace thicket
