// The acceleration grid. thrower.cpp compiles this file once for each instruction set.
#if defined(THICKET_POINT_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_POINT_CELLS_INL
#undef THICKET_POINT_CELLS_INL
#else
#define THICKET_POINT_CELLS_INL
#endif

#include "core/sampling/domain/cell_reach.hpp"
#include "core/sampling/domain/cell_store-inl.hpp"
#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/near-inl.hpp"

#include <glm/vec2.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// The acceleration grid (sections 3.1 and 4.3 of the paper, see DomainMethod). Its cells consist
/// of whole base squares and are stored in a CellStore. If `accumulate` is true, every cell within
/// a radius of a point stores the point, and a lookup reads one cell. Otherwise, only the point's
/// own cell stores it, and a lookup reads several cells.
template <typename Real, bool accumulate>
class PointCells {
public:
	/// Creates cells of width x width base squares. Throws std::bad_alloc.
	PointCells(const Frame<Real> &frame, std::uint32_t width) :
			frame_(frame), width_(width), pad_(accumulate ? 0 : (reach + width - 1) / width * width),
			cells_((frame.squares + 2 * pad_ + width - 1u) / width),
			store_(std::size_t{cells_.x} * cells_.y, likely_points(frame, width), accumulate ? block : block / 2) {}

	std::size_t bytes() const { return store_.bytes(); }

	/// Adds a point at a biased position. `square` is the base square in which its dart was thrown.
	void add(Real x, Real y, glm::uvec2 square) {
		if constexpr (accumulate) {
			for_each_image(frame_, x, y, square,
					[this](Real image_x, Real image_y, glm::ivec2 image) { spread(image_x, image_y, image); });
		} else {
			for_each_image(frame_, x, y, square, [this](Real image_x, Real image_y, glm::ivec2 image) {
				const glm::uvec2 cell = glm::uvec2(image + static_cast<int>(pad_)) / width_;
				add_to(cell, image_x, image_y);
			});
		}
	}

	/// Prefetches the data that `near` will read.
	HWY_INLINE void prefetch(glm::uvec2 square) const {
		const CellRange range = cells_around(square);
		if (!store_.sorted()) {
			for (std::uint32_t y = range.first.y; y <= range.last.y; ++y) {
				store_.fetch(index_of({range.first.x, y}), index_of({range.last.x, y}));
			}
			return;
		}
		const Real low = bottom_of(square.y) - static_cast<Real>(radius_);
		const Real high = bottom_of(square.y + 1) + static_cast<Real>(radius_);
		for (std::uint32_t y = range.first.y; y <= range.last.y; ++y) {
			const double low_height = height_in(y, low);
			const double high_height = height_in(y, high);
			for (std::uint32_t x = range.first.x; x <= range.last.x; ++x) {
				store_.fetch_part(index_of({x, y}), low_height, high_height);
			}
		}
	}

	/// Prefetches the data that `add` will read.
	HWY_INLINE void prefetch_add(glm::uvec2 square) const {
		const glm::uvec2 cell = (square + pad_) / width_;
		store_.fetch(index_of(cell), index_of(cell));
	}

	/// Returns the points that may lie within a radius of a part of a base square. The result is
	/// valid until the next call to a non-const method.
	Near<Real> near(glm::uvec2 square, const CenteredSquare<Real> &part) {
		const CenteredSquare<Real> box{part.x, part.y, static_cast<Real>(radius_ + margin_) + part.half_x,
				static_cast<Real>(radius_ + margin_) + part.half_y};
		if constexpr (accumulate) {
			return in_one_cell(square / width_, box);
		} else {
			return gather(cells_around(square), box);
		}
	}

	/// Calls visitor(x, y) with spans of unbiased coordinates, one cell at a time. Each point of
	/// the domain is visited once.
	template <class Visitor>
	void visit(Visitor &&visitor) const {
		std::vector<Real> xs;
		std::vector<Real> ys;
		for (std::uint32_t y = 0; y < cells_.y; ++y) {
			for (std::uint32_t x = 0; x < cells_.x; ++x) {
				xs.clear();
				ys.clear();
				store_.for_each(index_of({x, y}), [&](Real point_x, Real point_y) {
					if (is_home(point_x, point_y, {x, y})) {
						xs.push_back(frame_.to_plain(point_x));
						ys.push_back(frame_.to_plain(point_y));
					}
				});
				if (!xs.empty()) {
					visitor(xs, ys);
				}
			}
		}
	}

private:
	static constexpr std::uint32_t reach = squares_reached;
	static constexpr std::size_t block = Near<Real>::block;

	Frame<Real> frame_;
	std::uint32_t width_;
	std::uint32_t pad_; ///< Number of base squares added on each side of the domain, for images on a torus.
	glm::uvec2 cells_;
	double radius_ = frame_.reach.x * frame_.base.x;
	double margin_ = 4.0 * frame_.quantum; ///< Larger than any rounding error of a point or a square.
	/// Number of rows of base squares beyond its own from which a cell stores points.
	double skirt_ = accumulate ? frame_.reach.y : 0.0;
	double rows_per_meter_ = 1.0 / frame_.base.y;
	double heights_per_row_ = 1.0 / (width_ + 2.0 * skirt_);
	CellStore<Real> store_;
	std::vector<Real> gathered_x_;
	std::vector<Real> gathered_y_;

	struct CellRange {
		glm::uvec2 first;
		glm::uvec2 last;
	};

	/// Returns a likely number of points per cell: slightly above the mean of a jammed set, in
	/// which counts vary little. A base square contains at most one point.
	static double likely_points(const Frame<Real> &frame, std::uint32_t width) {
		constexpr double density = 0.6965; // Number of points per squared radius: 0.547070 * 4 / pi.
		const glm::dvec2 sides = static_cast<double>(width) / frame.reach;
		const double area =
				accumulate ? sides.x * sides.y + 2.0 * (sides.x + sides.y) + std::numbers::pi : sides.x * sides.y;
		const double mean = density * area;
		const double likely = mean + 0.6 * std::sqrt(mean);
		return accumulate ? likely : std::min(likely, static_cast<double>(width) * width - 1.0);
	}

	std::size_t index_of(glm::uvec2 cell) const { return std::size_t{cell.y} * cells_.x + cell.x; }

	/// Returns the cells that `near` reads.
	CellRange cells_around(glm::uvec2 square) const {
		if constexpr (accumulate) {
			return {square / width_, square / width_};
		} else {
			return {(square + pad_ - reach) / width_, (square + pad_ + reach) / width_};
		}
	}

	/// Returns the biased coordinate of the lower edge of a row of base squares.
	Real bottom_of(std::uint32_t row) const { return static_cast<Real>(row * frame_.base.y + frame_.bias); }

	/// Returns y relative to the range of y that a row of cells may store, clamped to 0 to 1.
	double height_in(std::uint32_t cell_row, Real y) const {
		const double rows = (static_cast<double>(y) - frame_.bias) * rows_per_meter_ + skirt_;
		const double first = static_cast<double>(cell_row) * width_ - pad_;
		return std::clamp((rows - first) * heights_per_row_, 0.0, 1.0);
	}

	/// Stores an image in every cell of the domain within a radius of the image. All of these cells
	/// are prefetched before the first one is written.
	void spread(Real x, Real y, glm::ivec2 square) {
		const NearCells cells(frame_, width_, x, y, square);
		for (std::size_t i = 0; i < cells.count; ++i) {
			fetch_for_adding(cells.cell[i], y);
		}
		for (std::size_t i = 0; i < cells.count; ++i) {
			add_to(cells.cell[i], x, y);
		}
	}

	void add_to(glm::uvec2 cell, Real x, Real y) {
		store_.add(index_of(cell), x, y, store_.sorted() ? height_in(cell.y, y) : 0.0);
	}

	HWY_INLINE void fetch_for_adding(glm::uvec2 cell, Real y) const {
		if (store_.sorted()) {
			const double height = height_in(cell.y, y);
			store_.fetch_part(index_of(cell), height, height);
		} else {
			store_.fetch(index_of(cell), index_of(cell));
		}
	}

	typename CellStore<Real>::Part part_in(glm::uvec2 cell, const CenteredSquare<Real> &box) const {
		if (!store_.sorted()) {
			return {0, store_.capacity()};
		}
		// Only the points at the height of the box are read.
		const Real low = box.y - box.half_y;
		const Real high = box.y + box.half_y;
		return store_.part(index_of(cell), low, high, height_in(cell.y, low), height_in(cell.y, high));
	}

	Near<Real> in_one_cell(glm::uvec2 cell, const CenteredSquare<Real> &box) {
		const std::size_t index = index_of(cell);
		const auto [begin, end] = part_in(cell, box);
		const Real *xs = store_.coordinates(index) + begin;
		const std::size_t lanes = (end - begin + block - 1) / block * block;
		if (!store_.overflows(index)) {
			// The stored points are returned without a copy.
			return {xs, xs + store_.capacity(), lanes};
		}
		reserve_points(lanes);
		std::copy_n(xs, lanes, gathered_x_.begin());
		std::copy_n(xs + store_.capacity(), lanes, gathered_y_.begin());
		std::size_t count = lanes;
		store_.for_each_overflowing(index, [&](Real x, Real y) { append(x, y, count); });
		return finished(count);
	}

	Near<Real> gather(const CellRange &range, const CenteredSquare<Real> &box) {
		std::size_t count = 0;
		for (std::uint32_t y = range.first.y; y <= range.last.y; ++y) {
			for (std::uint32_t x = range.first.x; x <= range.last.x; ++x) {
				if (store_.capacity() % block == 0) {
					gather_cell(hn::CappedTag<Real, block>(), {x, y}, box, count);
				} else {
					gather_cell(hn::CappedTag<Real, block / 2>(), {x, y}, box, count);
				}
			}
		}
		return finished(count);
	}

	/// Appends the points of a cell that lie in a box, and possibly points outside the box.
	template <class D>
	HWY_INLINE void gather_cell(D d, glm::uvec2 cell, const CenteredSquare<Real> &box, std::size_t &r_count) {
		const auto [begin, end] = part_in(cell, box);
		const Real *xs = store_.coordinates(index_of(cell));
		reserve_points(r_count + end - begin);
		for (std::size_t i = begin; i < end && xs[i] != Real{0}; i += hn::Lanes(d)) {
			const auto x = hn::LoadU(d, xs + i);
			const auto y = hn::LoadU(d, xs + store_.capacity() + i);
			const auto inside = hn::And(hn::Lt(hn::Abs(hn::Sub(x, hn::Set(d, box.x))), hn::Set(d, box.half_x)),
					hn::Lt(hn::Abs(hn::Sub(y, hn::Set(d, box.y))), hn::Set(d, box.half_y)));
			// Extracting single doubles from a vector costs more than it saves. If any of them is
			// inside, the whole vector is copied.
			constexpr bool pick = sizeof(Real) == sizeof(float);
			if (pick || !hn::AllFalse(d, inside)) {
				hn::StoreU(pick ? hn::Compress(x, inside) : x, d, gathered_x_.data() + r_count);
				hn::StoreU(pick ? hn::Compress(y, inside) : y, d, gathered_y_.data() + r_count);
				r_count += pick ? hn::CountTrue(d, inside) : hn::Lanes(d);
			}
		}
		if (store_.overflows(index_of(cell))) {
			store_.for_each_overflowing(index_of(cell), [&](Real x, Real y) { append(x, y, r_count); });
		}
	}

	/// Ensures space for `count` gathered points, and for one more block that may be written after
	/// them.
	void reserve_points(std::size_t count) {
		if (count + block > gathered_x_.size()) {
			gathered_x_.resize(2 * (count + block));
			gathered_y_.resize(2 * (count + block));
		}
	}

	void append(Real x, Real y, std::size_t &r_count) {
		reserve_points(r_count + 1);
		gathered_x_[r_count] = x;
		gathered_y_[r_count] = y;
		++r_count;
	}

	/// Pads the gathered points with zeros to a whole block, and returns them.
	Near<Real> finished(std::size_t count) {
		reserve_points(count);
		std::fill_n(gathered_x_.begin() + static_cast<std::ptrdiff_t>(count), block, Real{0});
		std::fill_n(gathered_y_.begin() + static_cast<std::ptrdiff_t>(count), block, Real{0});
		return {gathered_x_.data(), gathered_y_.data(), (count + block - 1) / block * block};
	}

	/// Returns true if `visit` reports the point from this cell. The result is false for images
	/// and, if `accumulate` is true, for copies in neighboring cells.
	bool is_home(Real x, Real y, glm::uvec2 cell) const {
		const glm::dvec2 at(static_cast<double>(x) - frame_.bias, static_cast<double>(y) - frame_.bias);
		if (at.x < 0.0 || at.y < 0.0 || at.x >= frame_.period.x || at.y >= frame_.period.y) {
			return false;
		}
		if constexpr (accumulate) {
			const glm::uvec2 square = glm::min(glm::uvec2(at / frame_.base), frame_.squares - 1u);
			return square / width_ == cell;
		}
		return true;
	}
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
