#pragma once

#include "core/base/rect.hpp"

#include <vector>

namespace thicket {

/// Adds an area of changed ground in meters to `r_areas`. Merges areas that touch; if there are too
/// many, merges all of them. Ignores an empty area.
void add_changed_area(std::vector<Rect> &r_areas, const Rect &area);

} // namespace thicket
