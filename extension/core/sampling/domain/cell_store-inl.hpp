// Stores the points of the acceleration grid. thrower.cpp compiles this file once for each
// instruction set.
#if defined(THICKET_CELL_STORE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_CELL_STORE_INL
#undef THICKET_CELL_STORE_INL
#else
#define THICKET_CELL_STORE_INL
#endif

#include "core/sampling/domain/near-inl.hpp"
#include "core/sampling/domain/zeroed_array.hpp"

#include <glm/vec2.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// Stores points by cell. Each cell has a fixed capacity, chosen so that it nearly always suffices;
/// excess points go to an overflow map (section 4.3 of the paper, see DomainMethod). Large cells
/// keep their points sorted by y, so that a lookup reads only some of them. Points fill a cell
/// evenly, so the lookup starts its search at an estimated index.
template <typename Real>
class CellStore {
public:
	static constexpr std::size_t block = Near<Real>::block;

	/// A range of entries of a cell: [begin, end). `begin` is a multiple of `block`.
	struct Part {
		std::size_t begin;
		std::size_t end;
	};

	/// Allocates space for more than `likely` points per cell, rounded up to a multiple of `least`,
	/// which is `block` or half a block. Sorted cells use whole blocks. Throws std::bad_alloc.
	CellStore(std::size_t cells, double likely, std::size_t least) :
			sorted_(likely > sorted_above), capacity_(rounded_up(likely, sorted_ ? block : least)),
			coordinates_(cells * 2 * capacity_), counts_(sorted_ ? cells : 0) {}

	std::size_t bytes() const { return coordinates_.bytes() + counts_.bytes() + overflow_bytes_; }
	std::size_t capacity() const { return capacity_; }
	bool sorted() const { return sorted_; }

	/// Returns the x coordinates of a cell, which are 0 for unused entries. The y coordinates start
	/// `capacity` entries later.
	const Real *coordinates(std::size_t cell) const { return coordinates_.data() + cell * 2 * capacity_; }

	bool overflows(std::size_t cell) const {
		return coordinates(cell)[capacity_ - 1] != Real{0} && overflow_.contains(cell);
	}

	/// Adds a point. `height` is its y, relative to the range of y that the cell stores, from 0 to
	/// 1.
	void add(std::size_t cell, Real x, Real y, double height) {
		Real *const xs = coordinates_.data() + cell * 2 * capacity_;
		const std::size_t count = sorted_ ? counts_[cell] : vacant(xs);
		if (count == capacity_) {
			overflow_[cell].push_back({x, y});
			overflow_bytes_ += sizeof(glm::vec<2, Real>);
			return;
		}
		std::size_t index = count;
		if (sorted_) {
			Real *const ys = xs + capacity_;
			index = first_not_below(ys, count, y, height);
			std::copy_backward(xs + index, xs + count, xs + count + 1);
			std::copy_backward(ys + index, ys + count, ys + count + 1);
			++counts_[cell];
		}
		xs[index] = x;
		xs[index + capacity_] = y;
	}

	/// Returns a range of a sorted cell that includes all its points with y in [low, high), and
	/// perhaps other points, but no points in the overflow map. The heights are as in `add`.
	Part part(std::size_t cell, Real low, Real high, double low_height, double high_height) const {
		const Real *ys = coordinates(cell) + capacity_;
		const std::size_t count = counts_[cell];
		const std::size_t low_guess = guess(low_height, count);
		std::size_t begin = (low_guess - std::min(low_guess, block)) / block * block;
		while (begin > 0 && ys[begin - 1] >= low) {
			begin -= block;
		}
		std::size_t end = std::min(guess(high_height, count) + block, count);
		while (end < count && ys[end] < high) {
			end = std::min(end + block, count);
		}
		return {begin, end};
	}

	/// Prefetches the cells from `first` to `last`. The function is inlined, because a compiler may
	/// remove calls to a function that only prefetches.
	HWY_INLINE void fetch(std::size_t first, std::size_t last) const {
		fetch_line_by_line(coordinates(first), coordinates(last + 1));
	}

	/// Prefetches the entries of a sorted cell that `part` will probably read.
	HWY_INLINE void fetch_part(std::size_t cell, double low_height, double high_height) const {
		__builtin_prefetch(counts_.data() + cell);
		const Real *low = coordinates(cell) + guess(low_height, capacity_);
		const Real *high = coordinates(cell) + guess(high_height, capacity_);
		fetch_line_by_line(low, high);
		fetch_line_by_line(low + capacity_, high + capacity_);
	}

	template <class Action>
	void for_each(std::size_t cell, Action &&action) const {
		const Real *xs = coordinates(cell);
		for (std::size_t i = 0; i < capacity_ && xs[i] != Real{0}; ++i) {
			action(xs[i], xs[i + capacity_]);
		}
		for_each_overflowing(cell, action);
	}

	template <class Action>
	void for_each_overflowing(std::size_t cell, Action &&action) const {
		if (const auto more = overflow_.find(cell); more != overflow_.end()) {
			for (const glm::vec<2, Real> point : more->second) {
				action(point.x, point.y);
			}
		}
	}

private:
	/// Points per cell from which cells are sorted. In smaller cells, reading all points is faster.
	static constexpr double sorted_above = 28.0;

	bool sorted_;
	std::size_t capacity_;
	ZeroedArray<Real> coordinates_;
	ZeroedArray<std::uint32_t> counts_; ///< Point counts of sorted cells.
	/// The map is never iterated, so its order does not matter.
	std::unordered_map<std::size_t, std::vector<glm::vec<2, Real>>> overflow_;
	std::size_t overflow_bytes_ = 0;

	static std::size_t rounded_up(double likely, std::size_t step) {
		return (static_cast<std::size_t>(likely) + step) / step * step;
	}

	/// Returns the first unused entry of an unsorted cell.
	std::size_t vacant(const Real *xs) const {
		const Wide<Real> d;
		for (std::size_t i = 0; i < capacity_; i += hn::Lanes(d)) {
			if (const auto lane = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, xs + i), hn::Zero(d))); lane >= 0) {
				return std::min(i + static_cast<std::size_t>(lane), capacity_);
			}
		}
		return capacity_;
	}

	/// Returns the index that corresponds to a height if the cell is evenly filled.
	static std::size_t guess(double height, std::size_t count) {
		return static_cast<std::size_t>(height * static_cast<double>(count));
	}

	/// Returns the index of the first sorted number that is not below `y`. The search goes in both
	/// directions from an estimate.
	static std::size_t first_not_below(const Real *ys, std::size_t count, Real y, double height) {
		std::size_t low = guess(height, count);
		std::size_t high = low;
		for (std::size_t step = block / 2; low > 0 && ys[low - 1] >= y; step *= 2) {
			high = low;
			low -= std::min(low, step);
		}
		for (std::size_t step = block / 2; high < count && ys[high] < y; step *= 2) {
			low = high;
			high = std::min(count, high + step);
		}
		return static_cast<std::size_t>(std::lower_bound(ys + low, ys + high, y) - ys);
	}

	static HWY_INLINE void fetch_line_by_line(const Real *begin, const Real *end) {
		constexpr std::size_t line = 64 / sizeof(Real);
		constexpr std::size_t most = 8 * line;
		for (const Real *entry = begin; entry < std::min(end, begin + most); entry += line) {
			__builtin_prefetch(entry);
		}
	}
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
