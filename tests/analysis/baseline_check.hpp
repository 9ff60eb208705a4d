#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket::analysis {

/// The domain [0, size.x) x [0, size.y) of a point set and the minimum distance of its points. All
/// lengths are in the unit of the points.
struct CheckedDomain {
	glm::dvec2 size{1.0}; ///< Above 0. With `toroidal`, at least 4 radii on each axis.
	double radius = 1.0;  ///< The minimum distance, above 0.
	bool toroidal = false;
	double tolerance = 1e-9; ///< A point covers radius * (1 + tolerance). 1e-12 to 0.1.
};

/// The results of `BaselineCheck`.
struct BaselineReport {
	std::uint64_t outside = 0; ///< Number of points outside the domain. The other checks ignore these points.
	/// Number of pairs whose squared distance, computed in double precision, is below radius^2.
	std::uint64_t too_close = 0;
	std::uint64_t gaps = 0; ///< Number of grid cells, about one radius wide, that contain a gap.
	/// Smallest squared distance among the compared pairs.
	double min_squared_distance = std::numeric_limits<double>::infinity();
	glm::dvec2 gap_at{0.0}; ///< A position in one of the gaps, if there are any.

	bool perfect() const { return outside == 0 && too_close == 0 && gaps == 0; }
};

/// Checks the distance of every pair and the coverage of every position, in double precision, for a
/// Poisson-disk set that fills a rectangle or torus.
///
/// Coverage is decided by recursive subdivision. A square is covered if it lies within the disk of
/// one point, with the tolerance added to the radius. It is a gap if its center is more than one
/// radius from every point. Any other square is split. A square narrower than the tolerance is
/// always either covered or a gap, so the recursion ends. Without gaps, every position has a point
/// within 1 + tolerance radii. With a gap, the set is missing a point. The running time is
/// proportional to the number of points and to the logarithm of 1 / tolerance.
class BaselineCheck {
public:
	static BaselineReport run(std::span<const glm::dvec2> points, const CheckedDomain &domain) {
		BaselineCheck check(domain);
		check.enter(points);
		check.check_pairs();
		check.check_positions();
		return check.report_;
	}

private:
	/// Upper bound on the points in a cell and its eight neighbors if the set keeps its minimum
	/// distance.
	static constexpr std::size_t max_nearby = 64;

	/// The points near a cell, relative to the center of the cell.
	struct Nearby {
		std::array<glm::dvec2, max_nearby> points;
		std::size_t count = 0;
	};

	CheckedDomain domain_;
	double radius_squared_;
	double reach_;     ///< The radius including the tolerance.
	glm::ivec2 cells_; ///< Number of cells per axis. Each is at least `reach_` wide, or as wide as the domain.
	glm::dvec2 cell_size_;
	std::vector<glm::dvec2> points_; ///< The points, sorted by cell.
	std::vector<std::size_t> cell_begin_;
	BaselineReport report_;

	explicit BaselineCheck(const CheckedDomain &domain) :
			domain_(domain), radius_squared_(domain.radius * domain.radius),
			reach_(domain.radius * (1.0 + domain.tolerance)), cells_(glm::max(glm::ivec2(domain.size / reach_), 1)),
			cell_size_(domain.size / glm::dvec2(cells_)) {}

	glm::ivec2 cell_of(glm::dvec2 point) const { return glm::min(glm::ivec2(point / cell_size_), cells_ - 1); }

	std::size_t index_of(glm::ivec2 cell) const {
		return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(cells_.x) + static_cast<std::size_t>(cell.x);
	}

	void enter(std::span<const glm::dvec2> points) {
		cell_begin_.assign(index_of({0, cells_.y}) + 2, 0);
		std::vector<glm::dvec2> inside_points;
		for (const glm::dvec2 point : points) {
			if (point.x >= 0.0 && point.y >= 0.0 && point.x < domain_.size.x && point.y < domain_.size.y) {
				inside_points.push_back(point);
				++cell_begin_[index_of(cell_of(point)) + 2];
			}
		}
		report_.outside = points.size() - inside_points.size();
		for (std::size_t i = 1; i < cell_begin_.size(); ++i) {
			cell_begin_[i] += cell_begin_[i - 1];
		}
		points_.resize(inside_points.size());
		for (const glm::dvec2 point : inside_points) {
			points_[cell_begin_[index_of(cell_of(point)) + 1]++] = point;
		}
	}

	/// Returns the vector from `from` to `to`. On a torus, it crosses the edges if that is shorter.
	glm::dvec2 offset(glm::dvec2 from, glm::dvec2 target) const {
		const glm::dvec2 straight = target - from;
		return domain_.toroidal ? straight - domain_.size * glm::round(straight / domain_.size) : straight;
	}

	static double squared(glm::dvec2 v) { return v.x * v.x + v.y * v.y; }

	/// Calls `visit` with the index of each point in the cell and its neighbors.
	template <typename Visit>
	void visit_nearby(glm::ivec2 cell, const Visit &visit) const {
		for (int y = cell.y - 1; y <= cell.y + 1; ++y) {
			for (int x = cell.x - 1; x <= cell.x + 1; ++x) {
				const glm::ivec2 wrapped((x + cells_.x) % cells_.x, (y + cells_.y) % cells_.y);
				if (!domain_.toroidal && wrapped != glm::ivec2(x, y)) {
					continue;
				}
				const std::size_t index = index_of(wrapped);
				for (std::size_t i = cell_begin_[index]; i < cell_begin_[index + 1]; ++i) {
					visit(i);
				}
			}
		}
	}

	void check_pairs() {
		for (std::size_t i = 0; i < points_.size(); ++i) {
			visit_nearby(cell_of(points_[i]), [&](std::size_t other) {
				if (other < i) {
					const double distance = squared(offset(points_[i], points_[other]));
					report_.too_close += distance < radius_squared_ ? 1 : 0;
					report_.min_squared_distance = std::min(report_.min_squared_distance, distance);
				}
			});
		}
	}

	void check_positions() {
		for (int y = 0; y < cells_.y; ++y) {
			for (int x = 0; x < cells_.x; ++x) {
				const glm::dvec2 middle = (glm::dvec2(x, y) + 0.5) * cell_size_;
				Nearby nearby;
				visit_nearby({x, y}, [&](std::size_t i) {
					if (nearby.count < max_nearby) {
						nearby.points[nearby.count++] = offset(middle, points_[i]);
					}
				});
				glm::dvec2 gap(0.0);
				if (!covered(gap, 0.5 * cell_size_, nearby)) {
					++report_.gaps;
					report_.gap_at = middle + gap;
				}
			}
		}
	}

	/// Returns true if the disks cover the rectangle with center `r_middle` and half size `half`.
	/// Otherwise sets `r_middle` to a position in a gap.
	bool covered(glm::dvec2 &r_middle, glm::dvec2 half, const Nearby &nearby) const {
		Nearby meeting;
		double nearest = std::numeric_limits<double>::infinity();
		for (std::size_t i = 0; i < nearby.count; ++i) {
			const glm::dvec2 middle_offset = glm::abs(nearby.points[i] - r_middle);
			if (squared(middle_offset + half) <= reach_ * reach_) {
				return true;
			}
			nearest = std::min(nearest, squared(middle_offset));
			if (squared(glm::max(middle_offset - half, 0.0)) < reach_ * reach_) {
				meeting.points[meeting.count++] = nearby.points[i];
			}
		}
		if (nearest > radius_squared_) {
			return false;
		}
		for (int child = 0; child < 4; ++child) {
			const glm::dvec2 towards(child & 1 ? 0.5 : -0.5, child & 2 ? 0.5 : -0.5);
			glm::dvec2 middle = r_middle + towards * half;
			if (!covered(middle, 0.5 * half, meeting)) {
				r_middle = middle;
				return false;
			}
		}
		return true;
	}
};

} // namespace thicket::analysis
