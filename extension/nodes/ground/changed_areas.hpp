#pragma once

#include "core/base/rect.hpp"

#include <vector>

namespace thicket {

/// The rectangle around both.
Rect around(const Rect &a, const Rect &b);

/// Adds an area of changed ground, in meters, and keeps the number of rectangles small: rectangles that meet are merged, and too many are
/// merged into one. An empty area adds nothing.
void add_changed_area(std::vector<Rect> &r_areas, const Rect &area);

} // namespace thicket
