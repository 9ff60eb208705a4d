#pragma once

#include "core/base/rect.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <vector>

namespace thicket {

inline constexpr int max_grid_side = 4096;
inline constexpr double max_grid_places = 1 << 20;

/// The middles of the fields when `rect` is divided into `size` of them, row by row, x fastest: like the pixels of an image. Refuses a
/// size below 1 or above max_grid_side, more than max_grid_places (`size`), and a rectangle that is not finite or ends before it starts
/// (`rect`). Replaces `r_places`.
Status grid_places(const Rect &rect, glm::ivec2 size, std::vector<glm::dvec2> &r_places);

/// Degrees between the ground's normal and straight up, 0 to 90; NAN where there is no ground.
float ground_slope(const Ground &ground);

} // namespace thicket
