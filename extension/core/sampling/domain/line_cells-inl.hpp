// The accumulator's grid in double precision. thrower.cpp compiles this file once for each
// instruction set.
#if defined(THICKET_LINE_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_LINE_CELLS_INL
#undef THICKET_LINE_CELLS_INL
#else
#define THICKET_LINE_CELLS_INL
#endif

#include "core/sampling/domain/cell_reach.hpp"
#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/point_cells-inl.hpp"
#include "core/sampling/domain/rounded_near-inl.hpp"
#include "core/sampling/domain/zeroed_array.hpp"

#include <glm/vec2.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// An accumulator (section 3.1 of the paper, see DomainMethod) whose lookups read one cache line.
/// Every cell within a radius of a point stores the point, with coordinates rounded to 16 bits. A
/// second grid stores each exact point once, in its own cell. A lookup reads that grid only if
/// rounding makes the result uncertain, about once in 250 lookups.
///
/// In a large domain, most stalls come from address translation (TLB misses). Neighboring cells
/// therefore share a page, and accepted points are stored in batches, so that their address lookups
/// overlap.
class LineCells {
public:
	/// Maximum cell width in base squares. The points of wider cells do not fit in a cache line.
	static constexpr std::uint32_t widest = 3;

	/// Creates cells of width x width base squares. Throws std::bad_alloc.
	LineCells(const Frame<double> &frame, std::uint32_t width) :
			frame_(frame), width_(width), cells_((frame.squares + width - 1u) / width), block_(block_shift(cells_)),
			blocks_across_(((cells_.x - 1) >> block_.x) + 1),
			scale_(width * std::max(frame.base.x, frame.base.y) + 2.0 * rim_, frame.limit),
			lines_(blocks_across_ * (((cells_.y - 1) >> block_.y) + 1) << (block_.x + block_.y)),
			points_(frame, points_width) {
		rounded_into_.fill(none);
	}

	std::size_t bytes() const { return lines_.bytes() + points_.bytes(); }

	/// Adds a point at a biased position. `square` is the base square in which its dart was thrown.
	void add(double x, double y, glm::uvec2 square) {
		if (added_count_ == added_.size()) {
			store_added();
		}
		added_[added_count_++] = {x, y, square};
		for_each_image(frame_, x, y, square, [this](double image_x, double image_y, glm::ivec2 image) {
			const NearCells cells(frame_, width_, image_x, image_y, image);
			for (std::size_t i = 0; i < cells.count; ++i) {
				round_into(cells.cell[i], image_x, image_y);
			}
		});
	}

	/// Prefetches the data that `near` will read.
	HWY_INLINE void prefetch(glm::uvec2 square) const { __builtin_prefetch(&lines_[index_of(square / width_)]); }

	/// Returns the points that may lie within a radius of a part of a base square. The result is
	/// valid until the next call to a non-const method.
	RoundedNear<LineCells> near(glm::uvec2 square, const CenteredSquare<double> &part) {
		const glm::uvec2 cell = square / width_;
		const std::size_t index = index_of(cell);
		if (may_be_rounded_into(index)) {
			store_rounded();
		}
		return {&lines_[index], scale_, corner_of(cell), this, square, part};
	}

	/// Returns the same points as `near`, with exact coordinates.
	Near<double> exactly_near(glm::uvec2 square, const CenteredSquare<double> &part) {
		store_added();
		return points_.near(square, part);
	}

	/// Calls visitor(x, y) with spans of unbiased coordinates. Each point of the domain is visited
	/// once.
	template <class Visitor>
	void visit(Visitor &&visitor) const {
		points_.visit(visitor);
		for (std::size_t i = 0; i < added_count_; ++i) {
			const double x = frame_.to_plain(added_[i].x);
			const double y = frame_.to_plain(added_[i].y);
			visitor({&x, 1}, {&y, 1});
		}
	}

private:
	static constexpr std::uint32_t points_width = 4;
	static constexpr std::size_t at_once = 32;
	static constexpr std::uint32_t none = 0xffffffff;

	struct Added {
		double x;
		double y;
		glm::uvec2 square;
	};

	struct Rounded {
		RoundedPoints *line;
		std::uint16_t x;
		std::uint16_t y;
	};

	Frame<double> frame_;
	std::uint32_t width_;
	glm::uvec2 cells_;
	glm::uvec2 block_; ///< Base-2 logarithm of a block's size in cells, on each axis.
	std::size_t blocks_across_;
	double radius_ = frame_.reach.x * frame_.base.x;
	/// The distance by which a line's points may lie outside its cell, plus a few rounding steps. A
	/// line is the cache line of a cell.
	double rim_ = radius_ * (1.0 + 0x1p-12);
	RoundedScale scale_;
	ZeroedArray<RoundedPoints> lines_;
	PointCells<double, false> points_;
	std::array<Added, at_once> added_; ///< Points that are not in `points_` yet.
	std::size_t added_count_ = 0;
	std::array<Rounded, at_once> rounded_; ///< Points that are not in `lines_` yet.
	/// The low bits of the indices of the lines, for fast comparison.
	std::array<std::uint32_t, at_once> rounded_into_;
	std::size_t rounded_count_ = 0;

	/// Returns the base-2 logarithm of the block size. A block of 8 x 8 lines fills a page of 4
	/// KiB. Narrow domains use smaller blocks.
	static glm::uvec2 block_shift(glm::uvec2 cells) {
		const auto shift = [](std::uint32_t across) {
			return across > 4 ? 3u : across > 2 ? 2u : across - 1;
		};
		return {shift(cells.x), shift(cells.y)};
	}

	std::size_t index_of(glm::uvec2 cell) const {
		const std::size_t block = (cell.y >> block_.y) * blocks_across_ + (cell.x >> block_.x);
		const glm::uvec2 within = cell & ((1u << block_) - 1u);
		return (block << (block_.x + block_.y)) + (within.y << block_.x) + within.x;
	}

	/// Returns the biased position from which a cell's steps are counted.
	glm::dvec2 corner_of(glm::uvec2 cell) const {
		return glm::dvec2(cell * width_) * frame_.base + (frame_.bias - rim_);
	}

	void round_into(glm::uvec2 cell, double x, double y) {
		if (rounded_count_ == at_once) {
			store_rounded();
		}
		const std::size_t index = index_of(cell);
		const glm::dvec2 steps = (glm::dvec2(x, y) - corner_of(cell)) * scale_.steps_per_meter + 0.5;
		rounded_into_[rounded_count_] = static_cast<std::uint32_t>(index);
		rounded_[rounded_count_++] = {
				&lines_[index], static_cast<std::uint16_t>(steps.x), static_cast<std::uint16_t>(steps.y)};
	}

	/// Returns true if `rounded_` may contain points for a line. A wrong result only stores the
	/// points early, which is harmless.
	bool may_be_rounded_into(std::size_t index) const {
		const hn::CappedTag<std::uint32_t, at_once> d;
		const auto wanted = hn::Set(d, static_cast<std::uint32_t>(index));
		for (std::size_t i = 0; i < at_once; i += hn::Lanes(d)) {
			if (!hn::AllFalse(d, hn::Eq(hn::LoadU(d, rounded_into_.data() + i), wanted))) {
				return true;
			}
		}
		return false;
	}

	/// Moves the points of `rounded_` to their lines. Points whose line is full are dropped.
	void store_rounded() {
		for (std::size_t i = 0; i < rounded_count_; ++i) {
			__builtin_prefetch(rounded_[i].line, 1);
		}
		for (std::size_t i = 0; i < rounded_count_; ++i) {
			RoundedPoints &line = *rounded_[i].line;
			const auto lane = static_cast<std::size_t>(std::find(line.x.begin(), line.x.end(), 0) - line.x.begin());
			if (lane < RoundedPoints::lanes) {
				line.x[lane] = rounded_[i].x;
				line.y[lane] = rounded_[i].y;
			}
		}
		rounded_count_ = 0;
		rounded_into_.fill(none);
	}

	/// Moves the points of `added_` to `points_`.
	void store_added() {
		for (std::size_t i = 0; i < added_count_; ++i) {
			points_.prefetch_add(added_[i].square);
		}
		for (std::size_t i = 0; i < added_count_; ++i) {
			points_.add(added_[i].x, added_[i].y, added_[i].square);
		}
		added_count_ = 0;
	}
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
