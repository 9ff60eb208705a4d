#pragma once

#include "tests/analysis/exact_distance.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket::analysis {

/// The domain that `DomainCheck` checks.
struct DomainShape {
	glm::dvec2 size;        ///< The domain is [0, size), meters.
	double radius;          ///< Meters.
	bool toroidal;          ///< Opposite edges meet; the period is `size`.
	double tolerance = 0.0; ///< Meters beyond the radius that still count as covered; at most radius / 8.
};

/// The allowed distance of a position beyond the radius from all points of a set, in this precision: four steps of
/// `Real` at the wider side of the domain or, if that is small, at eight radii. In single precision, a step is at most
/// 2^-22 of that, and a square that is abandoned is one or two steps wide.
template <typename Real>
double domain_tolerance(glm::dvec2 size, double radius) {
	const double extent = std::max({size.x, size.y, 8.0 * radius});
	return 4.0 * std::ldexp(extent, 2 - std::numeric_limits<Real>::digits);
}

/// The results of `DomainCheck`.
struct DomainReport {
	std::uint64_t points = 0;
	std::uint64_t outside = 0;   ///< Points that are not in [0, size).
	std::uint64_t too_close = 0; ///< Pairs closer than the radius, exactly.
	std::uint64_t uncovered = 0; ///< Cells of the check with an uncovered position.
	glm::dvec2 uncovered_at{0};  ///< Approximately one of these positions.
};

/// Checks a point set of a whole domain: distances without any rounding, and coverage by subdivision down to a fraction
/// of the tolerance. It shares no code with the samplers. Its grid has cells slightly wider than the radius, for any
/// ratio of the sides.
///
/// Coverage: a square within the disk (radius + tolerance) of one point is covered, any other is split. If a square's
/// diagonal is half of the tolerance and it is still not covered, all its positions are farther than radius + tolerance
/// / 2 from all points, so it is a gap. A set therefore passes if all gaps are smaller than tolerance / 2, and fails if
/// one is larger than the tolerance.
class DomainCheck {
public:
	/// Accepts points of any type with x and y. If `coverage` is false, coverage is not checked.
	template <typename Point>
	static DomainReport run(std::span<const Point> points, const DomainShape &shape, bool coverage) {
		std::vector<glm::dvec2> places;
		places.reserve(points.size());
		for (const Point &point : points) {
			places.emplace_back(static_cast<double>(point.x), static_cast<double>(point.y));
		}
		DomainCheck check(shape);
		check.report_.points = places.size();
		std::erase_if(places, [&](glm::dvec2 place) { return !check.inside(place); });
		check.report_.outside = check.report_.points - places.size();
		check.sort_into_cells(places);
		check.compare_pairs();
		if (coverage) {
			check.cover();
		}
		return check.report_;
	}

private:
	/// Disks reach at most into the next cell, even with a tolerance.
	static constexpr double cell_radii = 1.2;

	DomainShape shape_;
	glm::dvec2 period_;
	glm::ivec2 cells_;
	glm::dvec2 cell_;
	double reach_squared_;
	double least_side_;                ///< An uncovered square of this side is a gap.
	std::vector<std::uint32_t> begin_; ///< The first index in `places_` of each cell.
	std::vector<glm::dvec2> places_;
	std::vector<glm::dvec2>
			disks_; ///< A stack: the disks that meet a square are above those of the square that contains it.
	DomainReport report_;

	explicit DomainCheck(const DomainShape &shape) :
			shape_(shape), period_(shape.toroidal ? shape.size : glm::dvec2(0.0)),
			cells_(glm::max(glm::dvec2(1.0), glm::floor(shape.size / (cell_radii * shape.radius)))),
			cell_(shape.size / glm::dvec2(cells_)),
			reach_squared_((shape.radius + shape.tolerance) * (shape.radius + shape.tolerance)),
			least_side_(shape.tolerance / std::sqrt(8.0)) {}

	bool inside(glm::dvec2 place) const {
		return place.x >= 0.0 && place.y >= 0.0 && place.x < shape_.size.x && place.y < shape_.size.y;
	}

	std::size_t index_of(glm::ivec2 cell) const {
		return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
	}

	glm::ivec2 cell_of(glm::dvec2 place) const { return glm::min(glm::ivec2(place / cell_), cells_ - 1); }

	void sort_into_cells(const std::vector<glm::dvec2> &places) {
		begin_.assign(index_of({0, cells_.y}) + 1, 0);
		for (const glm::dvec2 place : places) {
			++begin_[index_of(cell_of(place)) + 1];
		}
		for (std::size_t i = 1; i < begin_.size(); ++i) {
			begin_[i] += begin_[i - 1];
		}
		std::vector<std::uint32_t> next = begin_;
		places_.resize(places.size());
		for (const glm::dvec2 place : places) {
			places_[next[index_of(cell_of(place))]++] = place;
		}
	}

	/// Calls visit(index of a place, shift of the image) for all places of the nine cells around a cell.
	template <typename Visitor>
	void around(glm::ivec2 cell, const Visitor &visit) const {
		for (int y = cell.y - 1; y <= cell.y + 1; ++y) {
			for (int x = cell.x - 1; x <= cell.x + 1; ++x) {
				glm::ivec2 at(x, y);
				glm::dvec2 shift(0.0);
				for (int axis = 0; axis < 2 && shape_.toroidal; ++axis) {
					shift[axis] = at[axis] < 0 ? -period_[axis] : at[axis] >= cells_[axis] ? period_[axis] : 0.0;
					at[axis] = (at[axis] + cells_[axis]) % cells_[axis];
				}
				if (at.x < 0 || at.y < 0 || at.x >= cells_.x || at.y >= cells_.y) {
					continue;
				}
				for (std::size_t i = begin_[index_of(at)]; i < begin_[index_of(at) + 1]; ++i) {
					visit(i, shift);
				}
			}
		}
	}

	/// On a torus, a cell may be beside another one twice. Its pairs then count twice.
	void compare_pairs() {
		for (int y = 0; y < cells_.y; ++y) {
			for (int x = 0; x < cells_.x; ++x) {
				for (std::size_t i = begin_[index_of({x, y})]; i < begin_[index_of({x, y}) + 1]; ++i) {
					around({x, y}, [&](std::size_t other, glm::dvec2) {
						report_.too_close +=
								other > i && compare_distance(places_[i], places_[other], period_, shape_.radius) < 0;
					});
				}
			}
		}
	}

	void cover() {
		for (int y = 0; y < cells_.y; ++y) {
			for (int x = 0; x < cells_.x; ++x) {
				disks_.clear();
				around({x, y}, [&](std::size_t i, glm::dvec2 shift) { disks_.push_back(places_[i] + shift); });
				report_.uncovered += covers(cell_ * glm::dvec2(x, y), cell_, 0) ? 0 : 1;
			}
		}
	}

	/// True if a square has no gap. Checks the disks from `first` on.
	bool covers(glm::dvec2 corner, glm::dvec2 side, std::size_t first) {
		const glm::dvec2 middle = corner + 0.5 * side;
		const std::size_t end = disks_.size();
		bool covered = false;
		bool middle_covered = false;
		for (std::size_t i = first; i < end && !covered; ++i) {
			const glm::dvec2 away = glm::abs(disks_[i] - middle);
			middle_covered = middle_covered || squared(away) < reach_squared_;
			covered = squared(away + 0.5 * side) < reach_squared_;
			if (squared(glm::max(away - 0.5 * side, 0.0)) < reach_squared_) {
				disks_.push_back(disks_[i]);
			}
		}
		if (!covered && middle_covered && std::max(side.x, side.y) >= least_side_) {
			covered = true;
			for (int child = 0; child < 4 && covered; ++child) {
				covered = covers(corner + 0.5 * side * glm::dvec2(child & 1, child >> 1), 0.5 * side, end);
			}
		} else if (!covered) {
			report_.uncovered_at = corner;
		}
		disks_.resize(end);
		return covered;
	}

	static double squared(glm::dvec2 v) { return v.x * v.x + v.y * v.y; }
};

} // namespace thicket::analysis
