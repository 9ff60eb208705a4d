#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>

namespace thicket {

/// Returns the length of the longest axis of a basis, which is its largest scale factor.
template <class Number>
Number largest_scale(const glm::mat<3, 3, Number> &basis) {
	return std::max({glm::length(basis[0]), glm::length(basis[1]), glm::length(basis[2])});
}

} // namespace thicket
