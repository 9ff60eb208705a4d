#pragma once

#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec2.hpp>

namespace thicket {

/// The area of an MTerrain node (github.com/mohsenph69/Godot-MTerrain-plugin) and its posts, the
/// height samples of its grid. ObjectGround calls the node's methods only inside this area. Outside
/// it, `get_height` returns 0 and `get_normal` reads memory out of bounds.
struct PostGridArea {
	godot::Rect2 rect;       ///< From first to last sample in the engine's x and z; empty if there are none.
	double spacing = 0.0;    ///< The distance between height samples in meters.
	glm::ivec2 last_post{0}; ///< The index of the last height sample in x and z.

	/// Reads the area of a node for which `is_post_grid` is true. The area is empty until the
	/// plugin has created its grid. Runs scripts.
	static PostGridArea of(const godot::Variant &p_node);

	/// Returns true if a position, in the engine's x and z, is inside the area. The far edges are
	/// outside, because there are no height samples beyond them.
	bool contains(glm::dvec2 position) const;

	/// Returns true if the plugin has loaded the height samples around a position inside the area.
	/// Until then, their heights are 0 and their stored normals are zero bytes, which do not occur
	/// in loaded ground. Runs scripts.
	bool is_loaded(const godot::Variant &p_node, glm::dvec2 position) const;
};

/// Returns true if a node has the methods of MTerrain, regardless of its class.
bool is_post_grid(const godot::Variant &p_node);

} // namespace thicket
