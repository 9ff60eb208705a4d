#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <vector>

namespace thicket {

inline constexpr int max_grid_side = 4096;
inline constexpr double max_grid_places = 1 << 20;

/// Divides `rect` into `size` fields and returns their centers, row by row with x fastest, like the pixels of an image. Refuses, as `size`,
/// a size below 1 or above max_grid_side and more than max_grid_places. Refuses, as `rect`, a rectangle that is not finite or ends before
/// it starts. Replaces `r_places`.
Status grid_places(const Rect &rect, glm::ivec2 size, std::vector<glm::dvec2> &r_places);

/// Degrees between the ground's normal and straight up, 0 to 90; NAN if there is no ground.
float ground_slope(const Ground &ground);

} // namespace thicket
