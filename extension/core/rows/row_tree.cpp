#include "core/rows/row_tree.hpp"

#include <glm/common.hpp>

#include <utility>

namespace thicket {

void RowTree::set(std::vector<std::uint32_t> items, std::span<const Rect> bounds) {
	items_ = std::move(items);
	tree_ = Bvh(items_.size());
	boxes_.resize(tree_.nodes());
	tree_.each([&](Bvh::Node node) {
		Rect &box = boxes_[tree_.index_of(node)];
		if (node.level > 0) {
			box = boxes_[tree_.index_of(tree_.first(node))];
			if (tree_.has_second(node)) {
				box = united(box, boxes_[tree_.index_of(tree_.second(node))]);
			}
			return;
		}
		box = bounds[tree_.begin(node)];
		for (std::size_t i = tree_.begin(node) + 1; i < tree_.end(node); ++i) {
			box = united(box, bounds[i]);
		}
	});
}

} // namespace thicket
