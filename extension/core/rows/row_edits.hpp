#pragma once

#include "core/base/rect.hpp"
#include "core/rows/row_set.hpp"

#include <vector>

namespace thicket {

/// Appends the areas in which points may have changed between two sets of rows; null means no rows. Along
/// a line, these areas begin at the first edited place and extend to the end of the line. Returns false
/// if points may have changed everywhere, for example because a setting differs.
bool find_row_edits(const RowSet *before, const RowSet *after, std::vector<Rect> &r_areas);

} // namespace thicket
