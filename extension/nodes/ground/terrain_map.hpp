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

/// The properties of HTerrain's square map, apart from heights: its position, its holes and its painted textures. The
/// map is upright: it may be moved, scaled, and rotated about the vertical only. This copy is safe on any thread.
struct TerrainMap {
	godot::Transform3D to_world;   ///< From map space, where x and z count posts.
	double last_post = 0.0;        ///< The map extends from 0 to this value, along x and z.
	WeightMap colors;              ///< The fourth channel is below one half in holes. Empty if there are no holes.
	std::vector<WeightMap> splats; ///< Four textures each. If empty, all ground has all textures.

	/// True for the maps of HTerrain, by their number, that are copied here. Heights are not among them.
	static bool copies(std::int64_t map);

	/// The position in map space.
	glm::dvec2 to_map(glm::dvec2 world) const;
	/// World meters of a height of the map.
	float height_in_world(double height) const;
	/// For positions in map space: true on the map and outside its holes.
	bool has_ground(glm::dvec2 position) const;
	/// Returns the channels of each splat map that belong to one of `textures`.
	std::vector<unsigned> channels_of(std::span<const std::int32_t> textures) const;
	/// The share of the ground that these channels cover.
	float weight(glm::dvec2 position, std::span<const unsigned> channels) const;
	/// The world rect around a part of the map.
	godot::Rect2 world_rect(const godot::Rect2 &p_part) const;
};

// An object's methods may belong to a script, which may do anything, including freeing the object. Objects are
// therefore stored as a Variant, which detects whether an object still exists and keeps reference-counted objects
// alive.

/// False if the value is not an object, or the object was freed.
bool has_method(const godot::Variant &p_object, const godot::StringName &p_method);

/// The result of a method; null if it cannot be called.
godot::Variant result_of(const godot::Variant &p_object, const godot::StringName &p_method,
		std::initializer_list<godot::Variant> p_arguments = {});

/// True for an integer and a float.
bool is_number(const godot::Variant &p_value);

/// The map of a node like HTerrain, whose data is `p_data`; null if it provides neither its transform nor its size.
std::shared_ptr<const TerrainMap> read_map(const godot::Variant &p_node, const godot::Variant &p_data);

} // namespace thicket
