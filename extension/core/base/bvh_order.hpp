#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstdint>
#include <span>

namespace thicket {

/// The sort key of an item.
struct BvhKey {
	glm::dvec2 position; ///< In the plane, finite, at any scale.
	std::uint32_t item;
};

/// Sorts items so that neighbors in space become neighbors in the list, for a tree over as many items as there are
/// keys. The lower items along the longer axis fill the first half of the tree's leaves, the others follow, and both
/// halves are divided in the same way. The order does not depend on the library's nth_element. O(n log n). Once
/// `cancel` is raised, returns within some milliseconds with an unspecified order.
void put_in_order(const Bvh &tree, std::span<BvhKey> r_keys, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
