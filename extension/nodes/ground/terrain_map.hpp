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

/// What HTerrain tells of its square map, apart from heights: where it lies, where it has holes, what it is painted
/// with. Upright: turned about the vertical, moved and scaled only. A copy, safe on any thread.
struct TerrainMap {
	godot::Transform3D to_world;   ///< From map space, where x and z count posts.
	double last_post = 0.0;        ///< The map reaches from 0 to here, along x and z.
	WeightMap colors;              ///< Whose fourth channel is below a half in holes. Empty: there are none.
	std::vector<WeightMap> splats; ///< Four textures each. Empty: all ground is of all textures.

	/// True for HTerrain's maps of which this is a copy, by their number; heights are not among them.
	static bool copies(std::int64_t map);

	/// The position in map space.
	glm::dvec2 to_map(glm::dvec2 world) const;
	/// World meters of a height that the map has.
	float height_in_world(double height) const;
	/// Of positions in map space: true on the map and outside its holes.
	bool has_ground(glm::dvec2 position) const;
	/// For each of the splats, the channels of it that are among some textures.
	std::vector<unsigned> channels_of(std::span<const std::int32_t> textures) const;
	/// How much of the ground is in these channels.
	float weight(glm::dvec2 position, std::span<const unsigned> channels) const;
	/// The world rect around a part of the map.
	godot::Rect2 world_rect(const godot::Rect2 &p_part) const;
};

// What may be called of an object is a script's, which may do anything: free the object, too. So it is held as a Variant, which
// knows whether it is still there and keeps what counts its references.

/// False for what is no object, or is no more.
bool has_method(const godot::Variant &p_object, const godot::StringName &p_method);

/// The result of a method; nothing if it cannot be called.
godot::Variant result_of(const godot::Variant &p_object, const godot::StringName &p_method,
		std::initializer_list<godot::Variant> p_arguments = {});

/// True for an integer and a float.
bool is_number(const godot::Variant &p_value);

/// The map of a node like HTerrain, whose data is `p_data`; null if it tells neither where it lies nor its size.
std::shared_ptr<const TerrainMap> read_map(const godot::Variant &p_node, const godot::Variant &p_data);

} // namespace thicket
