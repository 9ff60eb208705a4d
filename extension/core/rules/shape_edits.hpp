#pragma once

#include "core/base/rect.hpp"
#include "core/rules/shapes.hpp"

#include <vector>

namespace thicket {

/// Appends world rectangles outside which a valid shape has no effect: its bounds or, for a path,
/// the bounds of up to max_path_pieces pieces. The pieces of a winding road cover far less land
/// than its bounds. If memory runs out, the function fails and appends nothing.
Status add_touched(const Shape &shape, std::vector<Rect> &r_areas);

inline constexpr std::size_t max_path_pieces = 64;

/// Appends rectangles outside which two sets have the same density. Either set may be null. The
/// rectangles cover the shapes that are in only one of the sets, regardless of their order. The
/// function returns false and appends nothing if memory runs out. It does the same if the density
/// may differ anywhere, because the first including shape was added or the last one removed.
bool find_shape_edits(const ShapeSet *before, const ShapeSet *after, std::vector<Rect> &r_areas);

} // namespace thicket
