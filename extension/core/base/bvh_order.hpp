#pragma once

#include "core/base/bvh.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstdint>
#include <span>

namespace thicket {

/// What an item's place in the order is found by.
struct BvhKey {
	glm::dvec2 position; ///< In the plane, finite, at any scale.
	std::uint32_t item;
};

/// Puts items that lie near each other next to each other, for a tree over as many items as there are keys: the lower ones along
/// the longer axis into the first half of the tree's leaves, the others behind them, and so on within both. One order whatever
/// the library's nth_element. O(n log n). Once `cancel` is raised it returns within some milliseconds, with any order.
void put_in_order(const Bvh &tree, std::span<BvhKey> r_keys, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
