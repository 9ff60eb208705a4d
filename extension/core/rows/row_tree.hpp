#pragma once

#include "core/base/bvh.hpp"
#include "core/base/rect.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Finds the items of a list whose bounds meet a rectangle.
class RowTree {
public:
	/// Sets the items and their bounds. Nearby items should be near each other in the list: the edges of
	/// a line in their order, or items in the order of `put_in_order`.
	void set(std::vector<std::uint32_t> items, std::span<const Rect> bounds);

	/// Calls `visit` with each item that may meet a rectangle.
	template <class Visit>
	void visit(const Rect &rect, const Visit &visit) const {
		BvhStack<Bvh::Node> stack;
		if (!tree_.empty()) {
			stack.push(tree_.root());
		}
		while (!stack.empty()) {
			const Bvh::Node node = stack.pop();
			if (!meet(boxes_[tree_.index_of(node)], rect)) {
				continue;
			}
			if (node.level > 0) {
				stack.push(tree_.first(node));
				if (tree_.has_second(node)) {
					stack.push(tree_.second(node));
				}
				continue;
			}
			for (std::size_t i = tree_.begin(node); i < tree_.end(node); ++i) {
				visit(items_[i]);
			}
		}
	}

private:
	std::vector<std::uint32_t> items_;
	Bvh tree_;
	std::vector<Rect> boxes_; ///< Bounds of the tree's nodes.
};

} // namespace thicket
