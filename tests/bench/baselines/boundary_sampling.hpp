#pragma once

#include "tests/bench/baselines/torus_grid.hpp"
#include "tests/bench/common/random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

namespace thicket::bench {

/// Boundary sampling, the fast variant of the method of Dunbar and Humphreys, "A spatial data
/// structure for fast Poisson-disk sample generation" (2006). Each new point is on the circle of
/// radius 1 around an earlier point, at a uniform angle in one of the ranges that no other point's
/// disk covers. All ranges are equally likely. A random active point adds points until its whole
/// circle is covered.
///
/// When no circle has an open range, the disks cover the torus, so the sets are maximal. Points are
/// placed at distance 1 + 1e-9, so that rounding brings none closer than 1. Every position then has
/// a point within 1 + 2e-9. The sets are denser than those of dart throwing, and have a different
/// distribution. The method takes O(N) time. An object of this class keeps its memory between
/// calls.
class BoundarySampling {
public:
	/// Replaces `r_points` with a maximal set on the torus [0, side)^2, in which no two points are
	/// closer than 1. `side` is 11 to 1e5.
	void sample(double side, std::uint64_t seed, std::vector<glm::dvec2> &r_points) {
		grid_.reset(side);
		active_.clear();
		r_points.clear();

		Xoroshiro random(seed);
		const double x = unit(random) * side;
		insert(grid_.wrap({x, unit(random) * side}), r_points);
		while (!active_.empty()) {
			const std::uint32_t slot = random.below(static_cast<std::uint32_t>(active_.size()));
			const glm::dvec2 point = r_points[active_[slot]];
			active_[slot] = active_.back();
			active_.pop_back();
			surround(point, random, r_points);
		}
	}

private:
	static constexpr double distance = 1.0 + 1e-9;
	static constexpr double turn = 2.0 * std::numbers::pi;
	/// Number of cells to search in each direction. A disk that covers a part of a circle is at most
	/// 2 * `distance` away.
	static constexpr int reach = 1;

	/// Half the angle of a circle that the disk of a point on the circle covers.
	static constexpr double sixth = std::numbers::pi / 3.0;

	/// The open angles in [0, turn], as ranges that do not touch. Each disk adds at most one range.
	/// At most 20 points that keep their distance can be closer than 2 to a point (Oler 1961).
	struct Ranges {
		struct Range {
			double begin;
			double end;
		};

		std::array<Range, 24> ranges;
		std::uint32_t count = 1;

		Ranges() { ranges[0] = {0.0, turn}; }

		/// Removes the angles closer than `half` to `middle`, which may be up to one turn outside
		/// [0, turn].
		void cover(double middle, double half) {
			cover_straight(middle - half, middle + half);
			if (middle - half < 0.0) {
				cover_straight(middle - half + turn, middle + half + turn);
			}
			if (middle + half > turn) {
				cover_straight(middle - half - turn, middle + half - turn);
			}
		}

		void cover_straight(double begin, double end) {
			for (std::uint32_t i = 0; i < count;) {
				Range &range = ranges[i];
				if (end <= range.begin || begin >= range.end) {
					++i;
				} else if (begin > range.begin && end < range.end) {
					ranges[count++] = {end, range.end};
					range.end = begin;
					return;
				} else if (begin > range.begin) {
					range.end = begin;
					++i;
				} else if (end < range.end) {
					range.begin = end;
					++i;
				} else {
					range = ranges[--count];
				}
			}
		}
	};

	TorusGrid grid_;
	std::vector<std::uint32_t> active_;

	static double unit(Xoroshiro &random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

	void insert(glm::dvec2 point, std::vector<glm::dvec2> &r_points) {
		const auto index = static_cast<std::uint32_t>(r_points.size());
		grid_.insert(index, point);
		active_.push_back(index);
		r_points.push_back(point);
	}

	/// Places points on the circle around `center` until it is completely covered.
	void surround(glm::dvec2 center, Xoroshiro &random, std::vector<glm::dvec2> &r_points) {
		Ranges open = open_ranges(center);
		while (open.count > 0) {
			const Ranges::Range range = open.ranges[random.below(open.count)];
			const double angle = range.begin + (range.end - range.begin) * unit(random);
			insert(grid_.wrap(center + distance * glm::dvec2(std::cos(angle), std::sin(angle))), r_points);
			open.cover(angle, sixth);
		}
	}

	Ranges open_ranges(glm::dvec2 center) const {
		Ranges open;
		grid_.visit(center, reach, [&](std::uint32_t, glm::dvec2 offset) {
			const double squared = offset.x * offset.x + offset.y * offset.y;
			if (squared > 0.0 && squared < 4.0 * distance * distance && open.count > 0) {
				const double half = std::acos(0.5 / distance * std::sqrt(squared));
				const double angle = std::atan2(offset.y, offset.x);
				open.cover(angle < 0.0 ? angle + turn : angle, half);
			}
		});
		return open;
	}
};

} // namespace thicket::bench
