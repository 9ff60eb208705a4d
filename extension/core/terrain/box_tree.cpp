#include "core/terrain/box_tree.hpp"

#include "core/base/bvh_order.hpp"

#include <algorithm>

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

} // namespace thicket
