#pragma once

#include "tests/analysis/exact_distance.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace thicket::analysis {

/// The domain of the point set that `DomainCheck` checks.
struct DomainShape {
	glm::dvec2 size; ///< The domain is [0, size), meters.
	double radius;   ///< Minimum distance between points in meters.
	bool toroidal;   ///< True if opposite edges meet; the period is `size`.
	/// Tolerance that is added to the radius in the coverage check. Meters, at most radius / 8.
	double tolerance = 0.0;
	/// If positive, only the multiples of this distance must be covered, each of them. Meters, a power of two.
	double step = 0.0;
};

/// Returns the shape of a domain that is filled with coordinates of the type `Real`. In double precision, the
/// tolerance is 2^-49 of the longer side of the domain, or of eight radii if that is more.
///
/// In single precision, coordinates are multiples of a step: 2^-23 of the smallest power of two above that
/// length. The size is rounded down to whole steps. Distances are computed in floats, so a position that is
/// farther than the radius by less than 2^-20 of it may count as covered.
template <typename Real>
DomainShape domain_shape(glm::dvec2 size, double radius, bool toroidal) {
	const double extent = std::max({size.x, size.y, 8.0 * radius});
	if constexpr (std::is_same_v<Real, float>) {
		const double step = std::ldexp(1.0, std::ilogb(extent) + 1 - 23);
		return {glm::max(glm::floor(size / step), 1.0) * step, radius, toroidal, std::ldexp(radius, -20), step};
	} else {
		return {size, radius, toroidal, std::ldexp(extent, -49)};
	}
}

/// The results of `DomainCheck`.
struct DomainReport {
	std::uint64_t points = 0;
	std::uint64_t outside = 0;   ///< Number of points outside [0, size).
	std::uint64_t too_close = 0; ///< Number of pairs closer than the radius, compared exactly.
	std::uint64_t uncovered = 0; ///< Number of grid cells of this check that contain an uncovered position.
	glm::dvec2 uncovered_at{0};  ///< The approximate location of one uncovered position.
};

/// Checks a point set that fills a whole domain. It compares distances without rounding, and checks
/// coverage by subdivision down to a fraction of the tolerance. It shares no code with the
/// samplers. Its grid cells are slightly wider than the radius, whatever the aspect ratio of the
/// domain.
///
/// Coverage: a square is covered if it lies within the disk of one point, with the tolerance added
/// to the radius. It is a gap if no such disk contains its center. Any other square is split. A
/// square that is still not covered when its diagonal is at most half the tolerance counts as a
/// gap. All its positions are farther than radius + tolerance / 2 from every point. A set therefore
/// passes if every gap is smaller than tolerance / 2, and fails if any gap is larger than the
/// tolerance. With `step`, squares are split down to single positions instead, and each position is
/// compared with radius + tolerance.
class DomainCheck {
public:
	/// Checks a set. Points may have any type with members x and y. The coverage is checked only if
	/// `coverage` is true.
	template <typename Point>
	static DomainReport run(std::span<const Point> points, const DomainShape &shape, bool coverage) {
		std::vector<glm::dvec2> positions;
		positions.reserve(points.size());
		for (const Point &point : points) {
			positions.emplace_back(static_cast<double>(point.x), static_cast<double>(point.y));
		}
		DomainCheck check(shape);
		check.report_.points = positions.size();
		std::erase_if(positions, [&](glm::dvec2 position) { return !check.inside(position); });
		check.report_.outside = check.report_.points - positions.size();
		check.sort_into_cells(positions);
		check.compare_pairs();
		if (coverage) {
			check.cover();
		}
		return check.report_;
	}

private:
	/// Width of a cell in radii. A disk extends at most into the adjacent cells, even with the
	/// tolerance.
	static constexpr double cell_radii = 1.2;

	DomainShape shape_;
	glm::dvec2 period_;
	glm::ivec2 cells_;
	glm::dvec2 cell_;
	double reach_squared_;
	double min_side_;                  ///< An uncovered square narrower than this width is a gap.
	std::vector<std::uint32_t> begin_; ///< The index in `positions_` of each cell's first point.
	std::vector<glm::dvec2> positions_;
	std::vector<glm::dvec2> disks_; ///< A stack. Disks that intersect a square are above those of its parent square.
	DomainReport report_;

	explicit DomainCheck(const DomainShape &shape) :
			shape_(shape), period_(shape.toroidal ? shape.size : glm::dvec2(0.0)),
			cells_(glm::max(glm::dvec2(1.0), glm::floor(shape.size / (cell_radii * shape.radius)))),
			cell_(shape.size / glm::dvec2(cells_)),
			reach_squared_((shape.radius + shape.tolerance) * (shape.radius + shape.tolerance)),
			min_side_(shape.tolerance / std::sqrt(8.0)) {}

	bool inside(glm::dvec2 position) const {
		return position.x >= 0.0 && position.y >= 0.0 && position.x < shape_.size.x && position.y < shape_.size.y;
	}

	std::size_t index_of(glm::ivec2 cell) const {
		return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
	}

	glm::ivec2 cell_of(glm::dvec2 position) const { return glm::min(glm::ivec2(position / cell_), cells_ - 1); }

	void sort_into_cells(const std::vector<glm::dvec2> &positions) {
		begin_.assign(index_of({0, cells_.y}) + 1, 0);
		for (const glm::dvec2 position : positions) {
			++begin_[index_of(cell_of(position)) + 1];
		}
		for (std::size_t i = 1; i < begin_.size(); ++i) {
			begin_[i] += begin_[i - 1];
		}
		std::vector<std::uint32_t> next = begin_;
		positions_.resize(positions.size());
		for (const glm::dvec2 position : positions) {
			positions_[next[index_of(cell_of(position))]++] = position;
		}
	}

	/// Calls visit(index, shift) for each point in the 3 x 3 cells around `cell`. On a torus,
	/// adding `shift` to the point yields its image in that cell.
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

	/// On a small torus, the same cell may be a neighbor on both sides. Its pairs are then counted
	/// twice.
	void compare_pairs() {
		for (int y = 0; y < cells_.y; ++y) {
			for (int x = 0; x < cells_.x; ++x) {
				for (std::size_t i = begin_[index_of({x, y})]; i < begin_[index_of({x, y}) + 1]; ++i) {
					around({x, y}, [&](std::size_t other, glm::dvec2) {
						report_.too_close += other > i &&
								compare_distance(positions_[i], positions_[other], period_, shape_.radius) < 0;
					});
				}
			}
		}
	}

	void cover() {
		for (int y = 0; y < cells_.y; ++y) {
			for (int x = 0; x < cells_.x; ++x) {
				disks_.clear();
				around({x, y}, [&](std::size_t i, glm::dvec2 shift) { disks_.push_back(positions_[i] + shift); });
				const glm::dvec2 corner = cell_ * glm::dvec2(x, y);
				const bool is_covered = shape_.step > 0.0 ? covers_positions(glm::ceil(corner / shape_.step),
																	glm::min(glm::floor((corner + cell_) / shape_.step),
																			glm::ceil(shape_.size / shape_.step) - 1.0),
																	0)
														  : covers(corner, cell_, 0);
				report_.uncovered += is_covered ? 0 : 1;
			}
		}
	}

	/// Returns true if the square has no gap. Only the entries of `disks_` from index `first` on
	/// are considered.
	bool covers(glm::dvec2 corner, glm::dvec2 side, std::size_t first) {
		const glm::dvec2 middle = corner + 0.5 * side;
		const std::size_t end = disks_.size();
		bool is_covered = false;
		bool middle_covered = false;
		for (std::size_t i = first; i < end && !is_covered; ++i) {
			const glm::dvec2 offset = glm::abs(disks_[i] - middle);
			middle_covered = middle_covered || squared(offset) < reach_squared_;
			is_covered = squared(offset + 0.5 * side) < reach_squared_;
			if (squared(glm::max(offset - 0.5 * side, 0.0)) < reach_squared_) {
				disks_.push_back(disks_[i]);
			}
		}
		if (!is_covered && middle_covered && std::max(side.x, side.y) >= min_side_) {
			is_covered = true;
			for (int child = 0; child < 4 && is_covered; ++child) {
				is_covered = covers(corner + 0.5 * side * glm::dvec2(child & 1, child >> 1), 0.5 * side, end);
			}
		} else if (!is_covered) {
			report_.uncovered_at = corner;
		}
		disks_.resize(end);
		return is_covered;
	}

	/// Returns true if each position from `low` to `high`, in steps, is covered. Only the entries of
	/// `disks_` from index `first` on are considered. Coordinates are exact.
	bool covers_positions(glm::dvec2 low, glm::dvec2 high, std::size_t first) {
		if (low.x > high.x || low.y > high.y) {
			return true;
		}
		const std::size_t end = disks_.size();
		bool is_covered = false;
		for (std::size_t i = first; i < end && !is_covered; ++i) {
			const glm::dvec2 below = low * shape_.step - disks_[i];
			const glm::dvec2 above = high * shape_.step - disks_[i];
			is_covered = squared(glm::max(glm::abs(below), glm::abs(above))) < reach_squared_;
			if (squared(glm::max(glm::max(below, -above), 0.0)) < reach_squared_) {
				disks_.push_back(disks_[i]);
			}
		}
		if (!is_covered && disks_.size() > end && low != high) {
			const glm::dvec2 middle = glm::floor(0.5 * (low + high));
			is_covered = covers_positions(low, middle, end) &&
					covers_positions({middle.x + 1.0, low.y}, {high.x, middle.y}, end) &&
					covers_positions({low.x, middle.y + 1.0}, {middle.x, high.y}, end) &&
					covers_positions(middle + 1.0, high, end);
		} else if (!is_covered) {
			report_.uncovered_at = low * shape_.step;
		}
		disks_.resize(end);
		return is_covered;
	}

	static double squared(glm::dvec2 v) { return v.x * v.x + v.y * v.y; }
};

} // namespace thicket::analysis
