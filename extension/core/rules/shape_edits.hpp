#pragma once

#include "core/base/rect.hpp"
#include "core/rules/shapes.hpp"

#include <vector>

namespace thicket {

/// The world rectangles outside which a valid shape changes nothing: its bounds, or those of pieces of a path, at most
/// max_path_pieces, so that a long road does not stand for all the land that it leads around. Adds none where memory ends.
Status add_touched(const Shape &shape, std::vector<Rect> &r_areas);

inline constexpr std::size_t max_path_pieces = 64;

/// Appends the rectangles outside which two sets (null for none) give the same density everywhere: what shapes touch
/// that are in one set and not in the other, whatever their order. False, with nothing appended, where the density may
/// differ anywhere: the first including shape came, or the last one went; or where memory does not suffice to tell.
bool find_shape_edits(const ShapeSet *before, const ShapeSet *after, std::vector<Rect> &r_areas);

} // namespace thicket
