#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The layout of a bounding volume hierarchy over a sorted array. A leaf has up to `leaf_size`
/// consecutive items, and every other node has up to two consecutive nodes of the level below. The
/// tree stores only counts. Its owner stores the bounds of the nodes in a separate array, indexed
/// by `index_of(node)`.
class Bvh {
public:
	struct Node {
		std::uint32_t level; ///< 0 for leaves; parents have higher levels.
		std::uint32_t index; ///< Index of the node within its level.
	};

	static constexpr std::size_t leaf_size = 4;

	Bvh() = default;

	/// Creates a tree over `count` items, at most 2^32.
	explicit Bvh(std::size_t count) : count_(count) {
		std::size_t nodes = (count + leaf_size - 1) / leaf_size;
		while (nodes > 0) {
			level_begin_.push_back(level_begin_.back() + static_cast<std::uint32_t>(nodes));
			nodes = nodes > 1 ? (nodes + 1) / 2 : 0;
		}
	}

	bool empty() const { return count_ == 0; }
	std::size_t nodes() const { return level_begin_.back(); } ///< Total number of nodes, over all levels.
	std::size_t levels() const { return level_begin_.size() - 1; }
	std::size_t nodes(std::size_t level) const { return level_begin_[level + 1] - level_begin_[level]; }

	/// Returns the node that contains all items. Requires at least one item.
	Node root() const { return {static_cast<std::uint32_t>(levels() - 1), 0}; }

	/// Calls `visit` for every node, children before their parent.
	template <typename Visit>
	void each(Visit visit) const {
		for (std::uint32_t level = 0; level < levels(); ++level) {
			for (std::uint32_t index = 0; index < nodes(level); ++index) {
				visit(Node{level, index});
			}
		}
	}

	std::size_t index_of(Node node) const { return level_begin_[node.level] + node.index; }
	std::size_t begin(Node node) const { return static_cast<std::size_t>(node.index) * (leaf_size << node.level); }
	std::size_t end(Node node) const { return std::min(begin(node) + (leaf_size << node.level), count_); }

	/// These functions return the two children of a node above the leaves. The last node of a level
	/// may lack the second child.
	Node first(Node node) const { return {node.level - 1, node.index * 2}; }
	Node second(Node node) const { return {node.level - 1, node.index * 2 + 1}; }
	bool has_second(Node node) const { return node.index * 2 + 1 < nodes(node.level - 1); }

private:
	std::size_t count_ = 0;
	std::vector<std::uint32_t> level_begin_{0}; ///< Index of the first node of each level, plus the end.
};

/// The nodes that a traversal of a Bvh still has to visit. The traversal descends into one child of
/// a node and pushes the other.
template <typename T>
class BvhStack {
public:
	void push(const T &item) { items_[size_++] = item; }
	T pop() { return items_[--size_]; }
	bool empty() const { return size_ == 0; }

private:
	std::array<T, 34> items_; ///< Enough for all levels of a tree over 2^32 items, plus one.
	std::size_t size_ = 0;
};

} // namespace thicket
