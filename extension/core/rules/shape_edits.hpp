#pragma once

#include "core/base/rect.hpp"
#include "core/rules/shapes.hpp"

#include <vector>

namespace thicket {

/// Adds the world rectangles outside which a valid shape changes nothing: its bounds or, for a path, the bounds of at most
/// max_path_pieces pieces, so that a long road does not cover all the land it encloses. Adds none if memory runs out.
Status add_touched(const Shape &shape, std::vector<Rect> &r_areas);

inline constexpr std::size_t max_path_pieces = 64;

/// Appends the rectangles outside which two sets (null if there is none) have the same density everywhere. The
/// rectangles cover the shapes that are in only one of the sets, whatever their order. Returns false and appends
/// nothing if the density may differ anywhere, because the first including shape was added or the last one removed, or
/// if memory does not suffice.
bool find_shape_edits(const ShapeSet *before, const ShapeSet *after, std::vector<Rect> &r_areas);

} // namespace thicket
