#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstdint>
#include <span>

namespace thicket {

/// The sort key of an item of a `Bvh`.
struct BvhKey {
	glm::dvec2 position; ///< Must be finite; any unit.
	std::uint32_t item;
};

/// Sorts keys so that items close in space are close in the list. `tree` must have as many items as
/// there are keys. The items with the lower coordinates on the longer axis fill the first half of
/// the tree's leaves, and the remaining items fill the second half. Both halves are divided
/// recursively. The order does not depend on the standard library's nth_element. Takes O(n log n)
/// time. After `cancel` is set, the function returns within a few milliseconds and leaves the keys
/// in an unspecified order.
void put_in_order(const Bvh &tree, std::span<BvhKey> r_keys, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
