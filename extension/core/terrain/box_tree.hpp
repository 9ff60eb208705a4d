#pragma once

#include "core/base/bvh.hpp"
#include "core/terrain/box3.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Finds the boxes that touch a box, using a bounding volume hierarchy. Immutable.
class BoxTree {
public:
	BoxTree() = default;

	/// Builds the tree in O(n log n) time.
	explicit BoxTree(std::span<const Box3> boxes);

	/// Builds a tree over `count` items. `bounds_of` returns the box of an item.
	template <class BoundsOf>
	BoxTree(std::size_t count, BoundsOf bounds_of) : BoxTree(boxes_of(count, bounds_of)) {}

	/// Returns the box around all boxes, or `no_box` if there are none.
	const Box3 &bounds() const { return bounds_; }

	/// Calls `visit` with the index of each box that touches `box`, and of a few boxes that do not,
	/// in tree order.
	template <class Visit>
	void find(const Box3 &box, Visit visit) const {
		BvhStack<Bvh::Node> pending;
		if (!tree_.empty()) {
			pending.push(tree_.root());
		}
		while (!pending.empty()) {
			const Bvh::Node node = pending.pop();
			if (!touch(node_bounds_[tree_.index_of(node)], box)) {
				continue;
			}
			if (node.level == 0) {
				for (std::size_t at = tree_.begin(node); at < tree_.end(node); ++at) {
					visit(order_[at]);
				}
				continue;
			}
			if (tree_.has_second(node)) {
				pending.push(tree_.second(node));
			}
			pending.push(tree_.first(node));
		}
	}

	/// Replaces `r_items` with the items whose boxes touch `box`, in increasing order.
	template <class BoundsOf>
	void find(const Box3 &box, BoundsOf bounds_of, std::vector<std::uint32_t> &r_items) const {
		r_items.clear();
		find(box, [&](std::uint32_t item) {
			if (touch(bounds_of(item), box)) {
				r_items.push_back(item);
			}
		});
		sort_distinct(r_items);
	}

private:
	/// Sorts numbers that are all different.
	static void sort_distinct(std::vector<std::uint32_t> &r_numbers);

	template <class BoundsOf>
	static std::vector<Box3> boxes_of(std::size_t count, BoundsOf bounds_of) {
		std::vector<Box3> boxes(count);
		for (std::uint32_t item = 0; item < count; ++item) {
			boxes[item] = bounds_of(item);
		}
		return boxes;
	}

	Bvh tree_;
	std::vector<std::uint32_t> order_; ///< Indices of boxes, in tree order.
	std::vector<Box3> node_bounds_;    ///< Bounds of the tree's nodes, by Bvh::index_of().
	Box3 bounds_ = no_box;
};

} // namespace thicket
