#include "core/rules/shape_edits.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace thicket {

namespace {

std::span<const Shape> shapes_of(const ShapeSet *set) {
	return set != nullptr ? set->shapes() : std::span<const Shape>();
}

bool includes(std::span<const Shape> shapes) {
	return std::ranges::any_of(shapes, [](const Shape &shape) { return !shape.exclude; });
}

} // namespace

void add_touched(const Shape &shape, std::vector<Rect> &r_areas) {
	const std::size_t lines = shape.outline.size() < 2 ? 0 : shape.outline.size() - 1;
	if (shape.kind != ShapeKind::path || lines < 2) {
		r_areas.push_back(bounds(shape));
		return;
	}
	const std::size_t length = (lines + max_path_pieces - 1) / max_path_pieces;
	Shape piece = shape;
	for (std::size_t first = 0; first < lines; first += length) {
		const auto from = shape.outline.begin() + static_cast<std::ptrdiff_t>(first);
		piece.outline.assign(from, from + static_cast<std::ptrdiff_t>(std::min(length, lines - first) + 1));
		r_areas.push_back(bounds(piece));
	}
}

bool find_shape_edits(const ShapeSet *before, const ShapeSet *after, std::vector<Rect> &r_areas) {
	const std::span<const Shape> old_shapes = shapes_of(before);
	const std::span<const Shape> new_shapes = shapes_of(after);
	if (before == after) {
		return true;
	}
	if (includes(old_shapes) != includes(new_shapes)) {
		return false;
	}
	// Of shapes that are equal, each stands for one in the other set. Most are at the place where they were.
	std::vector<bool> kept(old_shapes.size(), false);
	for (std::size_t i = 0; i < new_shapes.size(); ++i) {
		std::size_t found = old_shapes.size();
		for (std::size_t step = 0; step < old_shapes.size() && found == old_shapes.size(); ++step) {
			const std::size_t at = (i + step) % old_shapes.size();
			found = !kept[at] && old_shapes[at] == new_shapes[i] ? at : found;
		}
		if (found < old_shapes.size()) {
			kept[found] = true;
		} else {
			add_touched(new_shapes[i], r_areas);
		}
	}
	for (std::size_t i = 0; i < old_shapes.size(); ++i) {
		if (!kept[i]) {
			add_touched(old_shapes[i], r_areas);
		}
	}
	return true;
}

} // namespace thicket
