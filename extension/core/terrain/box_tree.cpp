#include "core/terrain/box_tree.hpp"

#include "core/base/bvh_order.hpp"

#include <algorithm>
#include <bit>

namespace thicket {

BoxTree::BoxTree(std::span<const Box3> boxes) : tree_(boxes.size()) {
	std::vector<BvhKey> keys(boxes.size());
	for (std::uint32_t index = 0; index < boxes.size(); ++index) {
		const glm::dvec3 middle = boxes[index].min + (boxes[index].max - boxes[index].min) * 0.5;
		keys[index] = {{middle.x, middle.z}, index};
	}
	put_in_order(tree_, keys);
	order_.resize(boxes.size());
	std::ranges::transform(keys, order_.begin(), &BvhKey::item);
	node_bounds_.resize(tree_.nodes());
	tree_.each([&](Bvh::Node node) {
		Box3 &bounds = node_bounds_[tree_.index_of(node)];
		bounds = no_box;
		if (node.level == 0) {
			for (std::size_t at = tree_.begin(node); at < tree_.end(node); ++at) {
				bounds = with(bounds, boxes[order_[at]]);
			}
			return;
		}
		bounds = node_bounds_[tree_.index_of(tree_.first(node))];
		if (tree_.has_second(node)) {
			bounds = with(bounds, node_bounds_[tree_.index_of(tree_.second(node))]);
		}
	});
	if (!tree_.empty()) {
		bounds_ = node_bounds_[tree_.index_of(tree_.root())];
	}
}

void BoxTree::sort_distinct(std::vector<std::uint32_t> &r_numbers) {
	if (r_numbers.empty()) {
		return;
	}
	const auto [lowest, highest] = std::ranges::minmax(r_numbers);
	const std::size_t words = (highest - lowest) / 64 + std::size_t{1};
	if (words > r_numbers.size()) {
		std::ranges::sort(r_numbers);
		return;
	}
	// Dense numbers are marked in a row of bits, which is then read in order.
	std::vector<std::uint64_t> bits(words);
	for (const std::uint32_t number : r_numbers) {
		bits[(number - lowest) / 64] |= std::uint64_t{1} << ((number - lowest) % 64);
	}
	std::size_t end = 0;
	for (std::size_t word = 0; word < words; ++word) {
		for (std::uint64_t left = bits[word]; left != 0; left &= left - 1) {
			r_numbers[end++] =
					lowest + static_cast<std::uint32_t>(word * 64) + static_cast<std::uint32_t>(std::countr_zero(left));
		}
	}
}

} // namespace thicket
