#pragma once

#include "core/base/rect.hpp"

#include <vector>

namespace thicket {

/// The rectangle around both.
Rect around(const Rect &a, const Rect &b);

/// Adds where ground has changed, in meters, as few rectangles: those that meet become one, and too many become one as well. An
/// empty area adds nothing.
void add_changed_area(std::vector<Rect> &r_areas, const Rect &area);

} // namespace thicket
