#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A binary tree over things that stand in a row: its leaves are runs of `leaf_size` of them, and every two neighboring runs
/// make one of the level above. It knows counts alone; who owns the things keeps what each run is asked for in a vector, at
/// `slot`: level by level, the leaves first.
class RunTree {
public:
	struct Run {
		std::uint32_t level; ///< 0 for leaves.
		std::uint32_t index; ///< Within its level.
	};

	static constexpr std::size_t leaf_size = 4;

	RunTree() = default;

	/// Over `count` things, at most 2^32.
	explicit RunTree(std::size_t count) : count_(count) {
		std::size_t runs = (count + leaf_size - 1) / leaf_size;
		while (runs > 0) {
			level_begin_.push_back(level_begin_.back() + static_cast<std::uint32_t>(runs));
			runs = runs > 1 ? (runs + 1) / 2 : 0;
		}
	}

	bool empty() const { return count_ == 0; }
	std::size_t runs() const { return level_begin_.back(); } ///< Of all levels.
	std::size_t levels() const { return level_begin_.size() - 1; }
	std::size_t runs(std::size_t level) const { return level_begin_[level + 1] - level_begin_[level]; }

	/// The run that all things are in; only if there are any.
	Run root() const { return {static_cast<std::uint32_t>(levels() - 1), 0}; }

	/// Calls `visit` with every run, halves before what they make up.
	template <typename Visit>
	void each(Visit visit) const {
		for (std::uint32_t level = 0; level < levels(); ++level) {
			for (std::uint32_t index = 0; index < runs(level); ++index) {
				visit(Run{level, index});
			}
		}
	}

	std::size_t slot(Run run) const { return level_begin_[run.level] + run.index; }
	std::size_t begin(Run run) const { return static_cast<std::size_t>(run.index) * (leaf_size << run.level); }
	std::size_t end(Run run) const { return std::min(begin(run) + (leaf_size << run.level), count_); }

	/// The two halves of a run above the leaves. The last run of a level may have no second one.
	Run first(Run run) const { return {run.level - 1, run.index * 2}; }
	Run second(Run run) const { return {run.level - 1, run.index * 2 + 1}; }
	bool has_second(Run run) const { return run.index * 2 + 1 < runs(run.level - 1); }

private:
	std::size_t count_ = 0;
	std::vector<std::uint32_t> level_begin_{0}; ///< One more than levels.
};

/// What is still to be looked at on the way through a RunTree that goes into one half and leaves the other for later.
template <typename T>
class RunStack {
public:
	void push(const T &item) { items_[size_++] = item; }
	T pop() { return items_[--size_]; }
	bool empty() const { return size_ == 0; }

private:
	std::array<T, 34> items_; ///< One a level, and one more: more than 2^32 things have.
	std::size_t size_ = 0;
};

} // namespace thicket
