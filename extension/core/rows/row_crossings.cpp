#include "core/rows/row_crossings.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Returns true if a fraction of a segment is an end of its line.
bool is_end(const RowSegment &segment, double fraction) {
	return (segment.starts_line && fraction <= 0.0) || (segment.ends_line && fraction >= 1.0);
}

} // namespace

std::optional<glm::dvec2> crossing_of(const RowSegment &a, const RowSegment &b) {
	const glm::dvec2 along_a = a.to - a.from;
	const glm::dvec2 along_b = b.to - b.from;
	const double area = cross(along_a, along_b);
	if (area == 0.0) {
		return std::nullopt; // Parallel segments have no single crossing.
	}
	const double on_a = cross(b.from - a.from, along_b) / area;
	const double on_b = cross(b.from - a.from, along_a) / area;
	const bool apart = on_a < 0.0 || on_a > 1.0 || on_b < 0.0 || on_b > 1.0;
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
