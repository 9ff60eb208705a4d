#include "core/base/bvh_order.hpp"

#include "core/base/progress.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace thicket {

namespace {

/// Orders the items of a subtree recursively. `half_runs` is the number of leaves in its first
/// half.
void arrange(std::span<BvhKey> keys, std::size_t half_runs, const std::atomic<bool> *cancel) {
	if (half_runs == 0 || is_cancelled(cancel)) {
		return;
	}
	const std::size_t half = half_runs * Bvh::leaf_size;
	if (keys.size() <= half) {
		arrange(keys, half_runs / 2, cancel);
		return;
	}
	glm::dvec2 min = keys.front().position;
	glm::dvec2 max = min;
	for (const BvhKey &key : keys) {
		min = {std::min(min.x, key.position.x), std::min(min.y, key.position.y)};
		max = {std::max(max.x, key.position.x), std::max(max.y, key.position.y)};
	}
	const int axis = max.x - min.x >= max.y - min.y ? 0 : 1;
	std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(half), keys.end(),
			[axis](const BvhKey &a, const BvhKey &b) {
				return a.position[axis] < b.position[axis] || (a.position[axis] == b.position[axis] && a.item < b.item);
			});
	arrange(keys.first(half), half_runs / 2, cancel);
	arrange(keys.subspan(half), half_runs / 2, cancel);
}

} // namespace

void put_in_order(const Bvh &tree, std::span<BvhKey> r_keys, const std::atomic<bool> *cancel) {
	if (!tree.empty()) {
		arrange(r_keys, std::bit_ceil(tree.nodes(0)) / 2, cancel);
	}
}

} // namespace thicket
