#pragma once

#include "core/terrain/weight_map.hpp"

#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// What HTerrain tells of its square map, apart from heights: where it lies, where it has holes, what it is painted
/// with. Upright: turned about the vertical, moved and scaled only. A copy, safe on any thread.
struct TerrainMap {
	godot::Transform3D to_world;   ///< From map space, where x and z count posts.
	double last_post = 0.0;        ///< The map reaches from 0 to here, along x and z.
	WeightMap colors;              ///< Whose fourth channel is below a half in holes. Empty: there are none.
	std::vector<WeightMap> splats; ///< Four textures each. Empty: all ground is of all textures.

	/// True for HTerrain's maps of which this is a copy, by their number; heights are not among them.
	static bool copies(std::int64_t map);

	/// The place in map space.
	glm::dvec2 to_map(glm::dvec2 world) const;
	/// World meters of a height that the map has.
	float height_in_world(double height) const;
	/// True on the map and outside its holes.
	bool has_ground(glm::dvec2 place) const;
	/// For each of the splats, the channels of it that are among some textures.
	std::vector<unsigned> channels_of(std::span<const std::int32_t> textures) const;
	/// How much of the ground is in these channels.
	float weight(glm::dvec2 place, std::span<const unsigned> channels) const;
	/// The world rect around a part of the map.
	godot::Rect2 world_rect(const godot::Rect2 &p_part) const;
};

/// The result of a method of an object; nothing if it cannot be called.
godot::Variant result_of(godot::Object *p_object, const godot::StringName &p_method,
		std::initializer_list<godot::Variant> p_arguments = {});

/// True for an integer and a float.
bool is_number(const godot::Variant &p_value);

/// The map of a node like HTerrain, whose data is `p_data`; none if it tells no place or no size.
std::optional<TerrainMap> read_map(godot::Object *p_node, godot::Object *p_data);

} // namespace thicket
