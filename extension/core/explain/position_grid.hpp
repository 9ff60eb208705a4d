#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <vector>

namespace thicket {

inline constexpr int max_grid_side = 4096;
inline constexpr double max_grid_positions = 1 << 20;

/// Divides `rect` into a grid of `size` cells and replaces `r_positions` with their centers, row by
/// row with x fastest, like the pixels of an image. Returns an error that names `size` if the width
/// or height is below 1 or above max_grid_side, or if there are more than max_grid_positions cells.
/// Returns an error that names `rect` if the rectangle is inverted or not finite.
Status grid_positions(const Rect &rect, glm::ivec2 size, std::vector<glm::dvec2> &r_positions);

/// Returns the angle between the ground's normal and the up axis, 0 to 90 degrees, or NAN if there
/// is no ground.
float ground_slope(const Ground &ground);

} // namespace thicket
