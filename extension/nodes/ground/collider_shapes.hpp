#pragma once

#include "core/base/rect.hpp"

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/classes/shape3d.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <optional>

namespace thicket {

/// The box around a shape in its own space; none for one without an end or of an unknown kind. `r_points` grows by how many points of
/// the shape were looked at.
std::optional<godot::AABB> bounds_of(const godot::Ref<godot::Shape3D> &p_shape, std::size_t &r_points);

/// From above, the box stood up by a transform: meters of the engine's space.
Rect area_of(const godot::AABB &bounds, const godot::Transform3D &frame);

/// True for what stands in the tree as an instance of a TerrainScatter3D, a scene that it has put there or a part of one.
bool belongs_to_scatter(const godot::Node *p_node);

} // namespace thicket
