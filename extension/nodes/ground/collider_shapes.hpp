#pragma once

#include "core/base/rect.hpp"

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <optional>

namespace thicket {

/// The box around a shape in its own space; empty for a shape that is unbounded or unknown. Adds the number of the
/// shape's points that were read to `r_points`.
std::optional<godot::AABB> bounds_of(const godot::Ref<godot::Shape3D> &p_shape, std::size_t &r_points);

/// The area of the transformed box as seen from above, in meters of the engine's space.
Rect area_of(const godot::AABB &bounds, const godot::Transform3D &frame);

/// True for a node of a scene that a TerrainScatter3D has added for an instance: the root or any part of it.
bool belongs_to_scatter(const godot::Node *p_node);

} // namespace thicket
