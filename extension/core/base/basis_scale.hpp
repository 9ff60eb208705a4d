#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>

namespace thicket {

/// The length of the longest axis of a basis, that is, the largest factor by which it scales.
template <class Number>
Number largest_scale(const glm::mat<3, 3, Number> &basis) {
	return std::max({glm::length(basis[0]), glm::length(basis[1]), glm::length(basis[2])});
}

} // namespace thicket
