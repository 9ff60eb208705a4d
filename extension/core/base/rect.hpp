#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <cmath>

namespace thicket {

/// A half-open axis-aligned rectangle of the world, in meters. It contains a point p if min <= p <
/// max on both axes, so rectangles that share an edge never share a point. `x` is the engine's
/// world x, and `y` is the engine's world z.
struct Rect {
	glm::dvec2 min{0.0};
	glm::dvec2 max{0.0};

	constexpr bool contains(glm::dvec2 point) const {
		return min.x <= point.x && point.x < max.x && min.y <= point.y && point.y < max.y;
	}

	/// Returns true if the rectangle has no area, is inverted, or has a NAN bound.
	constexpr bool empty() const { return !(min.x < max.x && min.y < max.y); }

	constexpr glm::dvec2 size() const { return max - min; }
	constexpr glm::dvec2 center() const { return 0.5 * (min + max); }

	bool finite() const {
		return std::isfinite(min.x) && std::isfinite(min.y) && std::isfinite(max.x) && std::isfinite(max.y);
	}
};

/// Returns the common part of two rectangles, which is empty if they do not overlap.
inline Rect intersection(const Rect &a, const Rect &b) { return {glm::max(a.min, b.min), glm::min(a.max, b.max)}; }

/// Returns the smallest rectangle that contains two rectangles.
inline Rect united(const Rect &a, const Rect &b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

/// Returns a rectangle that is larger by `distance` meters on each side.
constexpr Rect expanded(const Rect &rect, double distance) { return {rect.min - distance, rect.max + distance}; }

/// Returns true if two rectangles overlap or touch, including their edges. A point is a rectangle
/// without an area.
constexpr bool meet(const Rect &a, const Rect &b) {
	return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

} // namespace thicket
