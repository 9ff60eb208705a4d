#include "core/rules/shape_edits.hpp"

#include "core/base/guard.hpp"

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

/// Appends the areas that a shape affects. Throws std::bad_alloc.
void add_areas(const Shape &shape, std::vector<Rect> &r_areas) {
	const std::size_t lines = shape.outline.size() < 2 ? 0 : shape.outline.size() - 1;
	if (shape.kind != ShapeKind::path || lines < 2) {
		r_areas.push_back(bounds(shape));
		return;
	}
	const std::size_t length = (lines + max_path_pieces - 1) / max_path_pieces;
	Shape segment_shape = shape;
	for (std::size_t first = 0; first < lines; first += length) {
		const auto from = shape.outline.begin() + static_cast<std::ptrdiff_t>(first);
		segment_shape.outline.assign(from, from + static_cast<std::ptrdiff_t>(std::min(length, lines - first) + 1));
		r_areas.push_back(bounds(segment_shape));
	}
}

/// Adds the areas of shapes that are in only one of the two sets. Throws std::bad_alloc.
void add_differences(std::span<const Shape> old_shapes, std::span<const Shape> new_shapes, std::vector<Rect> &r_areas) {
	// Equal shapes of the two sets are matched one to one. The search starts at the same index,
	// because most shapes keep their index.
	std::vector<bool> is_matched(old_shapes.size(), false);
	for (std::size_t i = 0; i < new_shapes.size(); ++i) {
		std::size_t found = old_shapes.size();
		for (std::size_t step = 0; step < old_shapes.size() && found == old_shapes.size(); ++step) {
			const std::size_t at = (i + step) % old_shapes.size();
			found = !is_matched[at] && old_shapes[at] == new_shapes[i] ? at : found;
		}
		if (found < old_shapes.size()) {
			is_matched[found] = true;
		} else {
			add_areas(new_shapes[i], r_areas);
		}
	}
	for (std::size_t i = 0; i < old_shapes.size(); ++i) {
		if (!is_matched[i]) {
			add_areas(old_shapes[i], r_areas);
		}
	}
}

/// Calls `add` to append areas. If memory runs out, the areas already appended are removed.
template <typename Add>
Status add_all_or_none(std::vector<Rect> &r_areas, double value, const Add &add) {
	const std::size_t before = r_areas.size();
	const Status status = guarded("shapes", value, add);
	if (!status.ok()) {
		r_areas.resize(before);
	}
	return status;
}

} // namespace

Status add_touched(const Shape &shape, std::vector<Rect> &r_areas) {
	return add_all_or_none(r_areas, 1.0, [&] { add_areas(shape, r_areas); });
}

bool find_shape_edits(const ShapeSet *before, const ShapeSet *after, std::vector<Rect> &r_areas) {
	const std::span<const Shape> old_shapes = shapes_of(before);
	const std::span<const Shape> new_shapes = shapes_of(after);
	if (before == after) {
		// Both sides are the same set, which has no edits.
		return true;
	}
	if (includes(old_shapes) != includes(new_shapes)) {
		return false;
	}
	return add_all_or_none(r_areas, static_cast<double>(old_shapes.size() + new_shapes.size()), [&] {
		add_differences(old_shapes, new_shapes, r_areas);
	}).ok();
}

} // namespace thicket
