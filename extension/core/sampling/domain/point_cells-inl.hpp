// The acceleration grid. Compiled once for each instruction set, by throwers.cpp.
#if defined(THICKET_POINT_CELLS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_POINT_CELLS_INL
#undef THICKET_POINT_CELLS_INL
#else
#define THICKET_POINT_CELLS_INL
#endif

#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/near-inl.hpp"
#include "core/sampling/domain/zeroed_array.hpp"

#include <glm/vec2.hpp>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <utility>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// The acceleration grid (sections 3.1 and 4.3 of the paper): cells of whole base squares, each with room for as many points as
/// are likely; what is beyond goes to an overflow. With `accumulate`, a point stands in every cell within a radius of it, and
/// a lookup reads one cell; without, it stands in its own, and a lookup reads the cells around.
template <typename Real, bool accumulate>
class PointCells {
public:
	/// Cells of width x width base squares. Throws std::bad_alloc.
	PointCells(const Frame<Real> &frame, std::uint32_t width) :
			frame_(frame), width_(width), pad_(accumulate ? 0 : (reach + width - 1) / width * width),
			cells_((frame.squares + 2 * pad_ + width - 1u) / width), capacity_(likely_points(frame, width)),
			places_(std::size_t{cells_.x} * cells_.y * 2 * capacity_) {}

	std::size_t bytes() const { return places_.bytes() + overflow_bytes_; }

	/// Adds a point at a biased position, whose dart was thrown in a base square.
	void add(Real x, Real y, glm::uvec2 square) {
		if constexpr (accumulate) {
			for_each_image(x, y, square,
					[this](Real image_x, Real image_y, glm::ivec2 image) { spread(image_x, image_y, image); });
		} else {
			for_each_image(x, y, square, [this](Real image_x, Real image_y, glm::ivec2 image) {
				const glm::uvec2 cell = glm::uvec2(image + static_cast<int>(pad_)) / width_;
				store(index_of(cell), image_x, image_y);
			});
		}
	}

	/// Fetches what `near` will read towards the cache.
	HWY_INLINE void prefetch(glm::uvec2 square) const {
		if constexpr (accumulate) {
			fetch(index_of(square / width_));
		} else {
			const glm::uvec2 first = (square + pad_ - reach) / width_;
			const glm::uvec2 last = (square + pad_ + reach) / width_;
			for (std::uint32_t y = first.y; y <= last.y; ++y) {
				fetch_row(index_of({first.x, y}), index_of({last.x, y}));
			}
		}
	}

	/// The points that can lie within a radius of a part of a base square. Valid until the next call.
	Near<Real> near(glm::uvec2 square, const CenteredSquare<Real> &part) {
		if constexpr (accumulate) {
			return whole_cell(index_of(square / width_));
		} else {
			return gather(square, part);
		}
	}

	/// Calls visitor(x, y) with spans of plain coordinates, a cell at a time; each point of the domain once.
	template <class Visitor>
	void visit(Visitor &&visitor) const {
		std::vector<Real> xs;
		std::vector<Real> ys;
		for (std::uint32_t y = 0; y < cells_.y; ++y) {
			for (std::uint32_t x = 0; x < cells_.x; ++x) {
				xs.clear();
				ys.clear();
				for_each_stored(index_of({x, y}), [&](Real point_x, Real point_y) {
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
	static constexpr std::uint32_t reach =
			2; ///< Base squares farther apart hold no points within a radius of each other.
	static constexpr std::size_t block = Near<Real>::block;
	static constexpr std::size_t most_neighbours = 2 * reach + 1;

	Frame<Real> frame_;
	std::uint32_t width_;
	std::uint32_t pad_; ///< Base squares around the domain, for the images of a torus.
	glm::uvec2 cells_;
	std::size_t capacity_;
	double radius_ = frame_.reach.x * frame_.base.x;
	double margin_ = 4.0 * frame_.quantum; ///< More than roundings move a point or a square.
	ZeroedArray<Real> places_; ///< For each cell its x, then its y; filled from the front, 0 where there is none.
	std::unordered_map<std::size_t, std::vector<glm::vec<2, Real>>> overflow_; ///< Only looked up, never walked.
	std::size_t overflow_bytes_ = 0;
	std::vector<Real> gathered_x_;
	std::vector<Real> gathered_y_;

	/// The mean of a jammed set and two standard deviations; counts in a jammed set vary little. At most one point a base square.
	static std::size_t likely_points(const Frame<Real> &frame, std::uint32_t width) {
		constexpr double density = 0.6965; // Points a square radius: 0.547070 * 4 / pi.
		const glm::dvec2 sides = static_cast<double>(width) / frame.reach;
		const double area =
				accumulate ? sides.x * sides.y + 2.0 * (sides.x + sides.y) + std::numbers::pi : sides.x * sides.y;
		const double mean = density * area;
		const double most = accumulate ? 1e9 : static_cast<double>(width) * width;
		const double likely = std::min(mean + 0.6 * std::sqrt(mean), most);
		const std::size_t step = accumulate ? block : block / 2;
		return (static_cast<std::size_t>(std::ceil(likely)) + step - 1) / step * step;
	}

	/// The columns (or rows) of cells that the disk around a place can reach, and their squared distances on that axis.
	struct Neighbours {
		int first;
		int count;
		std::array<double, most_neighbours> squared;

		Neighbours(const Frame<Real> &frame, std::uint32_t width, int axis, double place, int square) {
			const int wide = static_cast<int>(width);
			const int last_square = static_cast<int>(frame.squares[axis]) - 1;
			first = std::max(square - static_cast<int>(reach), 0) / wide;
			count = std::min(square + static_cast<int>(reach), last_square) / wide - first + 1;
			for (int i = 0; i < count; ++i) {
				const double low = (first + i) * wide * frame.base[axis];
				const double high = low + wide * frame.base[axis];
				const double distance = std::max({low - place, place - high, 0.0});
				squared[static_cast<std::size_t>(i)] = distance * distance;
			}
		}
	};

	std::size_t index_of(glm::uvec2 cell) const { return std::size_t{cell.y} * cells_.x + cell.x; }

	Real *xs(std::size_t cell) { return places_.data() + cell * 2 * capacity_; }
	const Real *xs(std::size_t cell) const { return places_.data() + cell * 2 * capacity_; }

	bool full(std::size_t cell) const { return xs(cell)[capacity_ - 1] != Real{0}; }

	/// Inlined, because a compiler may take a function that only fetches for one that does nothing.
	HWY_INLINE void fetch(std::size_t cell) const { fetch_row(cell, cell); }

	/// Fetches cells that lie side by side, of large ones the start: the rest follows by itself.
	HWY_INLINE void fetch_row(std::size_t first, std::size_t last) const {
		constexpr std::size_t line = 64;
		const char *begin = reinterpret_cast<const char *>(xs(first));
		const char *end = std::min(reinterpret_cast<const char *>(xs(last + 1)), begin + 8 * line);
		for (; begin < end; begin += line) {
			__builtin_prefetch(begin);
		}
	}

	/// Calls with the point itself, and on a torus with its images across the seams that are near.
	template <class Action>
	void for_each_image(Real x, Real y, glm::uvec2 square, Action &&action) const {
		const glm::ivec2 count(frame_.squares);
		const glm::ivec2 own(square);
		const auto shifts = [&](int axis) -> std::pair<int, int> {
			if (!frame_.toroidal) {
				return {0, 0};
			}
			return {own[axis] >= count[axis] - static_cast<int>(reach) ? -1 : 0,
					own[axis] < static_cast<int>(reach) ? 1 : 0};
		};
		const auto [first_x, last_x] = shifts(0);
		const auto [first_y, last_y] = shifts(1);
		for (int shift_y = first_y; shift_y <= last_y; ++shift_y) {
			for (int shift_x = first_x; shift_x <= last_x; ++shift_x) {
				action(x + static_cast<Real>(shift_x * frame_.period.x),
						y + static_cast<Real>(shift_y * frame_.period.y), own + glm::ivec2(shift_x, shift_y) * count);
			}
		}
	}

	/// Stores an image in every cell of the domain within a radius of it. All of them are fetched before the first is read.
	void spread(Real x, Real y, glm::ivec2 square) {
		const Neighbours columns(frame_, width_, 0, static_cast<double>(x) - frame_.bias, square.x);
		const Neighbours rows(frame_, width_, 1, static_cast<double>(y) - frame_.bias, square.y);
		const double limit = (radius_ + margin_) * (radius_ + margin_);
		std::array<std::size_t, most_neighbours * most_neighbours> near_cells;
		std::size_t count = 0;
		for (int row = 0; row < rows.count; ++row) {
			for (int column = 0; column < columns.count; ++column) {
				const std::size_t cell = index_of(glm::uvec2(columns.first + column, rows.first + row));
				near_cells[count] = cell;
				const bool within = columns.squared[static_cast<std::size_t>(column)] +
								rows.squared[static_cast<std::size_t>(row)] <
						limit;
				if (within) {
					fetch(cell);
					++count;
				}
			}
		}
		for (std::size_t i = 0; i < count; ++i) {
			store(near_cells[i], x, y);
		}
	}

	void store(std::size_t cell, Real x, Real y) {
		const Wide<Real> d;
		Real *const places = xs(cell);
		for (std::size_t i = 0; i < capacity_; i += hn::Lanes(d)) {
			const auto vacant = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, places + i), hn::Zero(d)));
			if (vacant >= 0) {
				const std::size_t place = i + static_cast<std::size_t>(vacant);
				places[place] = x;
				places[place + capacity_] = y;
				return;
			}
		}
		overflow_[cell].push_back({x, y});
		overflow_bytes_ += sizeof(glm::vec<2, Real>);
	}

	Near<Real> whole_cell(std::size_t cell) {
		const Real *places = xs(cell);
		if (!full(cell) || !overflow_.contains(cell)) {
			return {places, places + capacity_, capacity_};
		}
		std::size_t count = 0;
		for_each_stored(cell, [&](Real x, Real y) { append(x, y, count); });
		return finished(count);
	}

	Near<Real> gather(glm::uvec2 square, const CenteredSquare<Real> &part) {
		const glm::uvec2 first = (square + pad_ - reach) / width_;
		const glm::uvec2 last = (square + pad_ + reach) / width_;
		const CenteredSquare<Real> box{part.x, part.y, static_cast<Real>(radius_ + margin_) + part.half_x,
				static_cast<Real>(radius_ + margin_) + part.half_y};
		std::size_t count = 0;
		for (std::uint32_t y = first.y; y <= last.y; ++y) {
			for (std::uint32_t x = first.x; x <= last.x; ++x) {
				const std::size_t cell = index_of({x, y});
				if (capacity_ % block == 0) {
					gather_cell(hn::CappedTag<Real, block>(), cell, box, count);
				} else {
					gather_cell(hn::CappedTag<Real, block / 2>(), cell, box, count);
				}
			}
		}
		return finished(count);
	}

	/// Appends the points of a cell that lie in a box, perhaps with others.
	template <class D>
	HWY_INLINE void gather_cell(D d, std::size_t cell, const CenteredSquare<Real> &box, std::size_t &r_count) {
		make_room(r_count + capacity_);
		const Real *places = xs(cell);
		for (std::size_t i = 0; i < capacity_ && places[i] != Real{0}; i += hn::Lanes(d)) {
			const auto x = hn::LoadU(d, places + i);
			const auto y = hn::LoadU(d, places + capacity_ + i);
			const auto inside = hn::And(hn::Lt(hn::Abs(hn::Sub(x, hn::Set(d, box.x))), hn::Set(d, box.half_x)),
					hn::Lt(hn::Abs(hn::Sub(y, hn::Set(d, box.y))), hn::Set(d, box.half_y)));
			// Picking doubles out of a vector costs more than it saves, so a vector with one of them inside is taken whole.
			constexpr bool pick = sizeof(Real) == sizeof(float);
			if (pick || !hn::AllFalse(d, inside)) {
				hn::StoreU(pick ? hn::Compress(x, inside) : x, d, gathered_x_.data() + r_count);
				hn::StoreU(pick ? hn::Compress(y, inside) : y, d, gathered_y_.data() + r_count);
				r_count += pick ? hn::CountTrue(d, inside) : hn::Lanes(d);
			}
		}
		if (full(cell)) {
			for_each_overflowing(cell, [&](Real x, Real y) { append(x, y, r_count); });
		}
	}

	template <class Action>
	void for_each_stored(std::size_t cell, Action &&action) const {
		const Real *places = xs(cell);
		for (std::size_t i = 0; i < capacity_ && places[i] != Real{0}; ++i) {
			action(places[i], places[i + capacity_]);
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

	/// Room for `count` gathered points, and a vector that is written whole behind them.
	void make_room(std::size_t count) {
		if (count + block > gathered_x_.size()) {
			gathered_x_.resize(2 * (count + block));
			gathered_y_.resize(2 * (count + block));
		}
	}

	void append(Real x, Real y, std::size_t &r_count) {
		make_room(r_count + 1);
		gathered_x_[r_count] = x;
		gathered_y_[r_count] = y;
		++r_count;
	}

	/// Closes the gathered points with zeros.
	Near<Real> finished(std::size_t count) {
		make_room(count);
		std::fill_n(gathered_x_.begin() + static_cast<std::ptrdiff_t>(count), block, Real{0});
		std::fill_n(gathered_y_.begin() + static_cast<std::ptrdiff_t>(count), block, Real{0});
		return {gathered_x_.data(), gathered_y_.data(), (count + block - 1) / block * block};
	}

	/// The cell is the one that holds the point for `visit`: not an image's, and with `accumulate` not a neighbour's.
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
