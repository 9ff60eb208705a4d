#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vector_relational.hpp>

#include <limits>

namespace thicket {

/// A box in world meters. Windows are half-open; bounds are closed.
struct Box3 {
	glm::dvec3 min{0.0};
	glm::dvec3 max{0.0};
};

/// The bounds of an empty set.
inline constexpr Box3 no_box{
		glm::dvec3(std::numeric_limits<double>::infinity()), glm::dvec3(-std::numeric_limits<double>::infinity())};

/// Returns true for `no_box`.
inline bool is_empty(const Box3 &box) { return box.min.x > box.max.x; }

/// Returns the smallest box that contains a box and a position.
inline Box3 with(const Box3 &box, const glm::dvec3 &position) {
	return {glm::min(box.min, position), glm::max(box.max, position)};
}

/// Returns the smallest box that contains two boxes.
inline Box3 with(const Box3 &a, const Box3 &b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

/// Returns true if two closed boxes have a common position.
inline bool touch(const Box3 &a, const Box3 &b) {
	return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

} // namespace thicket
