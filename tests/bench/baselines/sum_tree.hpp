#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// A list of weights from which an index is chosen in proportion to its weight. A tree with eight children per node,
/// whose sums fill one cache line. Sums are recomputed from their children and never corrected by differences, so they
/// are exactly 0 if all their weights are. Setting and finding take O(log n).
class SumTree {
public:
	/// Resets to `count` weights of 0, at least one.
	void reset(std::size_t count) {
		levels_.clear();
		do {
			count = (count + fan - 1) / fan;
			levels_.emplace_back(count, Node{});
		} while (count > 1);
	}

	double total() const { return sum(levels_.back().front()); }

	/// Sets a weight, at least 0 and finite.
	void set(std::size_t index, double weight) {
		for (std::vector<Node> &level : levels_) {
			Node &node = level[index / fan];
			node.sums[index % fan] = weight;
			weight = sum(node);
			index /= fan;
		}
	}

	/// The index before which the weights add up to `target`, in [0, total()), up to rounding. Its weight is never 0.
	/// `total()` must be above 0.
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

	std::vector<std::vector<Node>> levels_; ///< The weights first, a single node last.

	static double sum(const Node &node) {
		const std::array<double, fan> &s = node.sums;
		return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
	}
};

} // namespace thicket::bench
