#pragma once

#include "core/base/rect.hpp"

#include <vector>

namespace thicket {

/// The rectangle around both.
Rect around(const Rect &a, const Rect &b);

/// Adds an area of changed ground, in meters. Keeps the number of rectangles small: merges rectangles that meet, and
/// merges all of them if there are too many. An empty area adds nothing.
void add_changed_area(std::vector<Rect> &r_areas, const Rect &area);

} // namespace thicket
