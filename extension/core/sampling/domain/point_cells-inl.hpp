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
			for_each_image(x, y, square, [this](Real image_x, Real image_y, glm::ivec2) { spread(image_x, image_y); });
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
				for (std::uint32_t x = first.x; x <= last.x; ++x) {
					fetch(index_of({x, y}));
				}
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

	Frame<Real> frame_;
	std::uint32_t width_;
	std::uint32_t pad_; ///< Base squares around the domain, for the images of a torus.
	glm::uvec2 cells_;
	std::size_t capacity_;
	ZeroedArray<Real> places_; ///< For each cell its x, then its y; filled from the front, 0 where there is none.
	std::unordered_map<std::size_t, std::vector<glm::vec<2, Real>>> overflow_; ///< Only looked up, never walked.
	std::size_t overflow_bytes_ = 0;
	std::vector<Real> gathered_x_ = std::vector<Real>(block);
	std::vector<Real> gathered_y_ = std::vector<Real>(block);

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

	std::size_t index_of(glm::uvec2 cell) const { return std::size_t{cell.y} * cells_.x + cell.x; }

	Real *xs(std::size_t cell) { return places_.data() + cell * 2 * capacity_; }
	const Real *xs(std::size_t cell) const { return places_.data() + cell * 2 * capacity_; }

	bool full(std::size_t cell) const { return xs(cell)[capacity_ - 1] != Real{0}; }

	HWY_INLINE void fetch(std::size_t cell) const {
		constexpr std::size_t line = 64;
		const char *place = reinterpret_cast<const char *>(xs(cell));
		for (std::size_t offset = 0; offset < std::min<std::size_t>(2 * capacity_ * sizeof(Real), 4 * line);
				offset += line) {
			__builtin_prefetch(place + offset);
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

	/// Stores an image in every cell of the domain within a radius of it.
	void spread(Real x, Real y) {
		const glm::dvec2 place(static_cast<double>(x) - frame_.bias, static_cast<double>(y) - frame_.bias);
		// A little more than the radius, for roundings.
		const glm::dvec2 around = frame_.reach * 1.0001;
		const glm::dvec2 at = place / frame_.base;
		const glm::dvec2 last_square = glm::dvec2(frame_.squares) - 1.0;
		const auto cell_at = [&](double squares, int axis) {
			return static_cast<std::uint32_t>(std::clamp(squares, 0.0, last_square[axis])) / width_;
		};
		if (at.x + around.x < 0.0 || at.y + around.y < 0.0 || at.x - around.x > last_square.x + 1.0 ||
				at.y - around.y > last_square.y + 1.0) {
			return;
		}
		for (std::uint32_t cell_y = cell_at(at.y - around.y, 1); cell_y <= cell_at(at.y + around.y, 1); ++cell_y) {
			for (std::uint32_t cell_x = cell_at(at.x - around.x, 0); cell_x <= cell_at(at.x + around.x, 0); ++cell_x) {
				if (cell_is_near({cell_x, cell_y}, at)) {
					store(index_of({cell_x, cell_y}), x, y);
				}
			}
		}
	}

	/// A cell lies within a radius of a place, given in base squares.
	bool cell_is_near(glm::uvec2 cell, glm::dvec2 at) const {
		const glm::dvec2 low = glm::dvec2(cell * width_);
		const double x = (at.x - std::clamp(at.x, low.x, low.x + width_)) / frame_.reach.x;
		const double y = (at.y - std::clamp(at.y, low.y, low.y + width_)) / frame_.reach.y;
		return x * x + y * y < 1.0001;
	}

	void store(std::size_t cell, Real x, Real y) {
		Real *places = xs(cell);
		Real *const end = places + capacity_;
		Real *const place = std::partition_point(places, end, [](Real taken) { return taken != Real{0}; });
		if (place != end) {
			place[0] = x;
			place[capacity_] = y;
			return;
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
		const Real radius = static_cast<Real>(frame_.reach.x * frame_.base.x * 1.0001);
		const Real reach_x = radius + part.half_x;
		const Real reach_y = radius + part.half_y;
		std::size_t count = 0;
		for (std::uint32_t y = first.y; y <= last.y; ++y) {
			for (std::uint32_t x = first.x; x <= last.x; ++x) {
				for_each_stored(index_of({x, y}), [&](Real point_x, Real point_y) {
					if (std::abs(point_x - part.x) < reach_x && std::abs(point_y - part.y) < reach_y) {
						append(point_x, point_y, count);
					}
				});
			}
		}
		return finished(count);
	}

	template <class Action>
	void for_each_stored(std::size_t cell, Action &&action) const {
		const Real *places = xs(cell);
		for (std::size_t i = 0; i < capacity_ && places[i] != Real{0}; ++i) {
			action(places[i], places[i + capacity_]);
		}
		if (full(cell)) {
			if (const auto more = overflow_.find(cell); more != overflow_.end()) {
				for (const glm::vec<2, Real> point : more->second) {
					action(point.x, point.y);
				}
			}
		}
	}

	void append(Real x, Real y, std::size_t &r_count) {
		if (r_count == gathered_x_.size()) {
			gathered_x_.resize(2 * r_count);
			gathered_y_.resize(2 * r_count);
		}
		gathered_x_[r_count] = x;
		gathered_y_[r_count] = y;
		++r_count;
	}

	Near<Real> finished(std::size_t count) {
		while (count % block != 0) {
			append(Real{0}, Real{0}, count);
		}
		return {gathered_x_.data(), gathered_y_.data(), count};
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
