#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// A list of weights from which an index can be chosen in proportion to its weight. It is a tree
/// with eight children per node, whose sums fill one cache line. Sums are always recomputed from
/// their children, so they are exactly 0 if all their weights are 0. Setting and finding take O(log
/// n) time.
class SumTree {
public:
	/// Resets the list to `count` weights of 0. `count` must be at least 1.
	void reset(std::size_t count) {
		levels_.clear();
		do {
			count = (count + fan - 1) / fan;
			levels_.emplace_back(count, Node{});
		} while (count > 1);
	}

	double total() const { return sum(levels_.back().front()); }

	/// Sets a weight, which must be at least 0 and finite.
	void set(std::size_t index, double weight) {
		for (std::vector<Node> &level : levels_) {
			Node &node = level[index / fan];
			node.sums[index % fan] = weight;
			weight = sum(node);
			index /= fan;
		}
	}

	/// Returns the index before which the weights add up to `target`, up to rounding. `target` must
	/// be in [0, total()), and `total()` above 0. The weight of the index is never 0.
	std::size_t find(double target) const {
		std::size_t index = 0;
		for (std::size_t level = levels_.size(); level-- > 0;) {
			const Node &node = levels_[level][index];
			std::size_t child = fan;
			for (std::size_t i = 0; i < fan; ++i) {
				if (node.sums[i] > 0.0) {
					child = i;
					if (target < node.sums[i]) {
						break;
					}
					target -= node.sums[i];
				}
			}
			index = index * fan + child;
		}
		return index;
	}

private:
	static constexpr std::size_t fan = 8;

	struct alignas(64) Node {
		std::array<double, fan> sums{};
	};

	/// The first level has the weights, and the last one a single node.
	std::vector<std::vector<Node>> levels_;

	static double sum(const Node &node) {
		const std::array<double, fan> &s = node.sums;
		return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
	}
};

} // namespace thicket::bench
