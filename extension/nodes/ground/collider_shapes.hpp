#pragma once

#include "core/base/rect.hpp"

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <optional>

namespace thicket {

/// Returns the bounds of a shape in its local space. Returns nothing for an unbounded or unknown
/// shape. Adds the number of points that were read to `r_points`.
std::optional<godot::AABB> bounds_of(const godot::Ref<godot::Shape3D> &p_shape, std::size_t &r_points);

/// Returns the bounding rectangle of the transformed box as seen from above, in the engine's x and
/// z.
Rect area_of(const godot::AABB &bounds, const godot::Transform3D &frame);

/// Returns true if a node is part of a scene that a TerrainScatter3D has added for an instance.
bool belongs_to_scatter(const godot::Node *p_node);

} // namespace thicket
