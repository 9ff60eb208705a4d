#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <cmath>

namespace thicket {

/// A half-open axis-aligned rectangle of the world, in meters. A point p lies in it exactly when min <= p < max on both axes, so rectangles
/// that share an edge never share a point. World x is `x`; the engine's world z is `y` here.
struct Rect {
	glm::dvec2 min{0.0};
	glm::dvec2 max{0.0};

	constexpr bool contains(glm::dvec2 point) const {
		return min.x <= point.x && point.x < max.x && min.y <= point.y && point.y < max.y;
	}

	/// True for a rectangle without an area, an inverted rectangle, and NAN.
	constexpr bool empty() const { return !(min.x < max.x && min.y < max.y); }

	constexpr glm::dvec2 size() const { return max - min; }
	constexpr glm::dvec2 center() const { return 0.5 * (min + max); }

	bool finite() const {
		return std::isfinite(min.x) && std::isfinite(min.y) && std::isfinite(max.x) && std::isfinite(max.y);
	}
};

/// The points that lie in both rectangles; empty if there are none.
inline Rect intersection(const Rect &a, const Rect &b) { return {glm::max(a.min, b.min), glm::min(a.max, b.max)}; }

/// True if two rectangles overlap or touch, edges included. A point is a rectangle without an area.
constexpr bool meet(const Rect &a, const Rect &b) {
	return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

} // namespace thicket
