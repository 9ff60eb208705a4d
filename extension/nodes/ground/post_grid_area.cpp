#include "nodes/ground/post_grid_area.hpp"

#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/variant/vector3.hpp>

#include <glm/common.hpp>

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

/// The normal that MTerrain decodes from three zero bytes.
const Vector3 unloaded_normal(-1, 0, -1);

double number_of(const Variant &p_node, const StringName &p_method) {
	const Variant value = result_of(p_node, p_method);
	return is_number(value) ? static_cast<double>(value) : 0.0;
}

} // namespace

bool is_post_grid(const Variant &p_node) {
	return has_method(p_node, "is_grid_created") && has_method(p_node, "get_pixel_width") &&
			has_method(p_node, "get_h_scale") && has_method(p_node, "get_offset") && has_method(p_node, "get_height");
}

PostGridArea PostGridArea::of(const Variant &p_node) {
	PostGridArea area;
	const Variant is_created = result_of(p_node, "is_grid_created");
	const Variant offset = result_of(p_node, "get_offset");
	if (is_created.get_type() != Variant::BOOL || !static_cast<bool>(is_created) ||
			offset.get_type() != Variant::VECTOR3) {
		return area;
	}
	const glm::dvec2 posts(number_of(p_node, "get_pixel_width"), number_of(p_node, "get_pixel_height"));
	const double spacing = number_of(p_node, "get_h_scale");
	if (!(posts.x >= 2.0 && posts.y >= 2.0 && posts.x < 1e6 && posts.y < 1e6 && spacing > 0.0)) {
		return area;
	}
	const Vector3 first = offset;
	area.spacing = spacing;
	area.last_post = glm::ivec2(posts) - 1;
	area.rect = Rect2(first.x, first.z, static_cast<real_t>(area.last_post.x * spacing),
			static_cast<real_t>(area.last_post.y * spacing));
	return area;
}

bool PostGridArea::contains(glm::dvec2 position) const {
	// At the far edges, MTerrain would read heights beyond the last samples.
	return position.x >= rect.position.x && position.y >= rect.position.y &&
			position.x < rect.position.x + rect.size.x && position.y < rect.position.y + rect.size.y;
}

bool PostGridArea::is_loaded(const Variant &p_node, glm::dvec2 position) const {
	const glm::dvec2 grid_position = (position - glm::dvec2(rect.position.x, rect.position.y)) / spacing;
	const glm::ivec2 first = glm::clamp(glm::ivec2(grid_position), glm::ivec2(0), last_post - 1);
	// The height samples at the border between two regions are stored in the first one. The square
	// between four samples may therefore need both regions, so two opposite samples are checked.
	for (const glm::ivec2 post : {first, first + 1}) {
		const Variant normal = result_of(p_node, "get_normal_by_pixel", {post.x, post.y});
		if (normal.get_type() == Variant::VECTOR3 && static_cast<Vector3>(normal) == unloaded_normal) {
			return false;
		}
	}
	return true;
}

} // namespace thicket
