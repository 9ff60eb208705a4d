#pragma once

#include "core/base/split_mix.hpp"
#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/zeroed_array.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The active squares, in which darts can still fall, in one list per level. A square is chosen at
/// random by area (section 3.3 of the paper; see DomainMethod). All lists allocate equal chunks
/// from a common pool and return them to it. Memory use is therefore the peak of all lists
/// together, not the sum of their peaks.
template <typename Real>
class ActiveSquares {
public:
	static constexpr int max_levels = 34;

	/// The random bits of one choice.
	struct Draw {
		std::uint64_t level;
		std::uint64_t index;
	};

	struct Choice {
		std::uint32_t level;
		std::uint32_t index;
	};

	/// Creates empty lists. `expected` is the expected total number of squares. It determines the
	/// chunk size, which is a compromise between few chunks and little unused memory.
	explicit ActiveSquares(std::uint64_t expected) {
		const auto wanted = std::bit_ceil(expected / 512 + 1);
		chunk_shift_ =
				static_cast<std::uint32_t>(std::countr_zero(std::clamp<std::uint64_t>(wanted, 1u << 8, 1u << 16)));
	}

	bool empty() const { return held_ == 0; }
	std::uint64_t created_count() const { return created_count_; }
	std::uint64_t list_checks() const { return list_checks_; }
	std::uint32_t levels_used() const { return levels_used_; }
	/// Returns the number of squares that were created at each level.
	std::vector<std::uint64_t> created_by_level() const {
		std::vector<std::uint64_t> created;
		for (std::uint32_t level = 0; level < levels_used_; ++level) {
			created.push_back(lists_[level].created);
		}
		return created;
	}
	/// Returns the peak memory in bytes.
	std::size_t bytes() const { return max_chunks_ * chunk_bytes(); }

	void push(std::uint32_t level, Square<Real> square) {
		List &list = lists_[level];
		if (list.count == list.chunks.size() << chunk_shift_) {
			add_chunk(list);
			levels_used_ = std::max(levels_used_, level + 1);
		}
		at(list, list.count++) = square;
		++list.created;
		first_ = std::min(first_, level);
		set_area(level);
		total_ += unit_area(level);
		++held_;
		++created_count_;
	}

	/// Removes a square from its list and returns it. The last square of the list moves to its
	/// index.
	Square<Real> take(Choice choice) {
		List &list = lists_[choice.level];
		Square<Real> &taken = at(list, choice.index);
		const Square<Real> square = taken;
		taken = at(list, --list.count);
		__builtin_prefetch(&at(list, list.count - std::min(list.count, soon_last)));
		if ((list.count & ((1u << chunk_shift_) - 1)) == 0) {
			spare_.push_back(list.chunks.back());
			list.chunks.pop_back();
		}
		set_area(choice.level);
		total_ -= unit_area(choice.level);
		--held_;
		while (first_ + 1 < levels_used_ && lists_[first_].count == 0) {
			// Choices start at the first nonempty list.
			++first_;
		}
		if (total_ < stale_below_ || --fresh_for_ == 0) {
			sum_areas();
		}
		return square;
	}

	/// Chooses a square by random bits, with a probability proportional to its area.
	Choice choose(const Draw &draw) {
		std::uint32_t checks = 0;
		const Choice choice = look_up(draw, checks);
		list_checks_ += checks;
		return choice;
	}

	/// Predicts the result of a later `choose` with the same bits. The prediction is usually right,
	/// because the bits map to the same list index until that square is taken or the list becomes
	/// too short.
	Choice foresee(const Draw &draw) const {
		std::uint32_t checks = 0;
		return look_up(draw, checks);
	}

	/// Returns the square at a predicted index, or null if the list has become too short.
	const Square<Real> *peek(Choice choice) const {
		const List &list = lists_[choice.level];
		return choice.index < list.count ? &at(list, choice.index) : nullptr;
	}

private:
	struct List {
		std::vector<Square<Real> *> chunks;
		std::uint64_t count = 0;
		std::uint64_t created = 0;
	};

	static constexpr std::uint32_t fresh_choices = 4096;
	static constexpr std::uint64_t soon_last = 64; ///< The end of a list is prefetched this many squares ahead.

	std::array<List, max_levels> lists_;
	std::array<double, max_levels> areas_{}; ///< Total area of the squares in each list, in base squares.
	std::vector<ZeroedArray<Square<Real>>> slabs_;
	std::vector<Square<Real> *> spare_; ///< Chunks that no list uses.
	std::size_t created_chunks_ = 0;
	std::size_t max_chunks_ = 0; ///< Peak number of chunks in use.
	std::uint32_t chunk_shift_;
	std::uint32_t levels_used_ = 0;
	std::uint32_t first_ = max_levels - 1; ///< The first list that may be nonempty.
	std::uint32_t fresh_for_ = fresh_choices;
	double total_ = 0.0;
	double stale_below_ = 0.0; ///< Below this total, rounding errors accumulated in `total_` may matter.
	std::uint64_t held_ = 0;
	std::uint64_t created_count_ = 0;
	std::uint64_t list_checks_ = 0;

	static double unit_area(std::uint32_t level) {
		return std::bit_cast<double>((1023 - 2 * std::uint64_t{level}) << 52);
	}

	void set_area(std::uint32_t level) { areas_[level] = static_cast<double>(lists_[level].count) * unit_area(level); }

	void sum_areas() {
		total_ = 0.0;
		for (std::uint32_t level = levels_used_; level-- > 0;) {
			total_ += areas_[level];
		}
		stale_below_ = 0x1p-16 * total_;
		fresh_for_ = fresh_choices;
	}

	Square<Real> &at(const List &list, std::uint64_t index) const {
		const auto chunk = static_cast<std::size_t>(index >> chunk_shift_);
		return list.chunks[chunk][index & ((std::uint64_t{1} << chunk_shift_) - 1)];
	}

	std::size_t chunk_bytes() const { return sizeof(Square<Real>) << chunk_shift_; }

	void add_chunk(List &r_list) {
		if (spare_.empty()) {
			add_slab();
		}
		r_list.chunks.push_back(spare_.back());
		spare_.pop_back();
		max_chunks_ = std::max(max_chunks_, created_chunks_ - spare_.size());
	}

	/// Allocates many chunks at once, half as many as exist already, because only a large block of
	/// memory gets large pages. The untouched part of a block costs nothing.
	void add_slab() {
		constexpr std::size_t largest = std::size_t{1} << 26;
		const std::size_t chunks = std::clamp<std::size_t>(created_chunks_ / 2, 1, largest / chunk_bytes());
		slabs_.emplace_back(chunks << chunk_shift_);
		for (std::size_t chunk = chunks; chunk-- > 0;) {
			spare_.push_back(slabs_.back().data() + (chunk << chunk_shift_));
		}
		created_chunks_ += chunks;
	}

	/// Implements equation 3 of the paper: finds a list by linear search, then draws an index in
	/// it. Indices are drawn below the next power of two until one lies in the list.
	Choice look_up(const Draw &draw, std::uint32_t &r_checks) const {
		double rest = static_cast<double>(draw.level >> 11) * 0x1p-53 * total_;
		std::uint32_t level = first_;
		std::uint32_t found = first_;
		for (; level < levels_used_; ++level) {
			++r_checks;
			if (lists_[level].count > 0) {
				// Remembers the last nonempty list, in case rounding moves the search past the end.
				found = level;
			}
			if (rest < areas_[level]) {
				break;
			}
			rest -= areas_[level];
		}
		const std::uint64_t count = lists_[found].count;
		const std::uint64_t mask = std::bit_ceil(count) - 1;
		std::uint64_t bits = draw.index;
		while ((bits & mask) >= count) {
			bits = split_mix(bits + split_mix_gamma);
		}
		return {found, static_cast<std::uint32_t>(bits & mask)};
	}
};

} // namespace thicket
