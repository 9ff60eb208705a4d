#include "core/rows/row_crossings.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Returns the range of fractions of a segment, with the ends of its line extended by `extension` meters.
glm::dvec2 extended_range(const RowSegment &segment, glm::dvec2 along, double extension) {
	const double fraction = extension / glm::length(along);
	return {segment.starts_line ? -fraction : 0.0, segment.ends_line ? 1.0 + fraction : 1.0};
}

/// Returns true if a fraction of a segment is an end of its line, or beyond it.
bool is_end(const RowSegment &segment, double fraction) {
	return (segment.starts_line && fraction <= 0.0) || (segment.ends_line && fraction >= 1.0);
}

} // namespace

std::optional<glm::dvec2> crossing_of(const RowSegment &a, const RowSegment &b, double extension) {
	const glm::dvec2 along_a = a.to - a.from;
	const glm::dvec2 along_b = b.to - b.from;
	const double area = cross(along_a, along_b);
	if (area == 0.0) {
		return std::nullopt; // Parallel segments have no single crossing.
	}
	const double on_a = cross(b.from - a.from, along_b) / area;
	const double on_b = cross(b.from - a.from, along_a) / area;
	const glm::dvec2 range_a = extended_range(a, along_a, extension);
	const glm::dvec2 range_b = extended_range(b, along_b, extension);
	const bool apart = on_a < range_a.x || on_a > range_a.y || on_b < range_b.x || on_b > range_b.y;
	if (apart || (is_end(a, on_a) && is_end(b, on_b))) {
		return std::nullopt;
	}
	return a.from + along_a * on_a;
}

void RowCrossings::set(std::vector<glm::dvec2> positions) {
	positions_ = std::move(positions);
	std::ranges::sort(positions_, [](glm::dvec2 a, glm::dvec2 b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
}

bool RowCrossings::is_near(glm::dvec2 position, double distance) const {
	const auto x_of = [](glm::dvec2 crossing) {
		return crossing.x;
	};
	for (auto at = std::ranges::lower_bound(positions_, position.x - distance, {}, x_of);
			at != positions_.end() && at->x <= position.x + distance; ++at) {
		const glm::dvec2 gap = *at - position;
		if (gap.x * gap.x + gap.y * gap.y < distance * distance) {
			return true;
		}
	}
	return false;
}

} // namespace thicket
