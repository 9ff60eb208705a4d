#pragma once

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace thicket::bench {

inline double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }
inline double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }
inline glm::dvec2 normalized(glm::dvec2 v) { return v / std::sqrt(dot(v, v)); }

/// A disk. All positions in this file are relative to the point that owns the sectors.
struct Disk {
	glm::dvec2 center{0.0};
	double radius = 1.0;
};

/// The part of a disk's circle that faces the origin, or the part that faces away from it.
struct Arc {
	Disk disk;
	/// 1 for the part that rays from the origin meet last, -1 for the part that they meet first.
	double side = 1.0;

	/// Returns the distance from the origin to the arc along the unit vector `ray`. If the ray
	/// misses the circle, returns the distance to the closest point of the ray.
	double at(glm::dvec2 ray) const {
		const double offset = cross(disk.center, ray);
		return dot(disk.center, ray) + side * std::sqrt(std::max(disk.radius * disk.radius - offset * offset, 0.0));
	}

	/// Returns the area between the arc from `a` to `b` and its chord, which is positive if the arc
	/// is beyond the chord. The arc must be less than half of the circle.
	double bulge(glm::dvec2 a, glm::dvec2 b) const {
		// The sine of half the angle at the center.
		const double sine = 0.5 * std::sqrt(dot(b - a, b - a)) / disk.radius;
		const double square = sine * sine;
		if (sine < 0.15) {
			// The angle minus its sine, as a series, because the direct difference would lose
			// precision.
			const double tail = 3.0 / 14.0 + square * (5.0 / 36.0 + square * (35.0 / 352.0 + square * (63.0 / 832.0)));
			const double series = square * sine * (4.0 / 3.0 + square * (2.0 / 5.0 + square * tail));
			return 0.5 * side * disk.radius * disk.radius * series;
		}
		const double bounded = std::min(sine, 1.0);
		const double segment = 2.0 * (std::asin(bounded) - bounded * std::sqrt(1.0 - bounded * bounded));
		return 0.5 * side * disk.radius * disk.radius * segment;
	}
};

/// A region around the origin. It consists of all positions on the rays from `from` to `to` (less
/// than half a turn to the left) that are beyond the arc `near` and before the arc `far`. See
/// Dunbar and Humphreys (2006), section 3.
struct ScallopedSector {
	glm::dvec2 from{1.0, 0.0}; ///< Has length 1, like `to`.
	glm::dvec2 to{1.0, 0.0};
	Arc near;
	Arc far;
	/// The distances from the origin at which the first and the last ray meet the arcs.
	double near_from = 0.0;
	double near_to = 0.0;
	double far_from = 0.0;
	double far_to = 0.0;
	double area = 0.0;

	/// Computes the distances and the area after the rays and arcs were set.
	void measure() {
		near_from = near.at(from);
		near_to = near.at(to);
		far_from = far.at(from);
		far_to = far.at(to);
		area = area_until(to, near_to, far_to);
	}

	/// Returns the area from the ray `from` to the ray `ray`, which meets the arcs at the distances
	/// `near_at` and `far_at`.
	double area_until(glm::dvec2 ray, double near_at, double far_at) const {
		const double straight =
				0.5 * cross(from, ray) * (far_from * (far_at - near_at) + near_at * (far_from - near_from));
		return straight + far.bulge(far_from * from, far_at * ray) - near.bulge(near_from * from, near_at * ray);
	}

	/// Maps two numbers in [0, 1) to a position. Uniform numbers produce uniform positions.
	/// Newton's method finds the ray, with bisection if it leaves the interval. Along the ray, the
	/// density increases with the distance.
	glm::dvec2 point_at(double turned, double along) const {
		double low = 0.0;
		double high = 1.0;
		double mix = turned;
		for (int step = 0;; ++step) {
			const glm::dvec2 towards = from + mix * (to - from);
			const double squared = dot(towards, towards);
			const glm::dvec2 ray = towards / std::sqrt(squared);
			const double near_at = near.at(ray);
			const double far_at = far.at(ray);
			const double excess = area_until(ray, near_at, far_at) - turned * area;
			const double thick = std::max(far_at * far_at - near_at * near_at, 0.0);
			if (std::abs(excess) <= 1e-12 * area || step == max_steps) {
				return std::sqrt(near_at * near_at + along * thick) * ray;
			}
			(excess > 0.0 ? high : low) = mix;
			const double slope = 0.5 * thick * cross(from, to) / squared;
			const double next = mix - excess / slope;
			mix = next > low && next < high ? next : 0.5 * (low + high);
		}
	}

	/// Returns true if the disk certainly misses the sector. The test is cheap but incomplete: the
	/// disk may miss the sector although the result is false. The origin must be outside the disk,
	/// or `disk` must have radius 2.
	bool misses(const Disk &disk) const {
		const double squared = dot(disk.center, disk.center);
		const double max_distance = std::max(far_from, far_to) + disk.radius;
		if (squared >= max_distance * max_distance || cross(from, disk.center) <= -disk.radius ||
				cross(to, disk.center) >= disk.radius) {
			return true;
		}
		return squared + 1.0 >= disk.radius * disk.radius && dot(from, disk.center) <= 0.0 &&
				dot(to, disk.center) <= 0.0;
	}

	/// Returns true if the disk certainly contains the sector. This is a cheap test of the corners.
	/// The near arc bends into their convex hull, and so does the far arc if it belongs to another
	/// point's disk. The origin's own circle bends outward, but a disk that contains the origin
	/// covers a contiguous range of it.
	bool within(const Disk &disk) const {
		const double squared = disk.radius * disk.radius;
		const auto contains = [&](glm::dvec2 point) {
			const glm::dvec2 offset = point - disk.center;
			return dot(offset, offset) <= squared;
		};
		if (!contains(far_from * from) || !contains(far_to * to)) {
			return false;
		}
		return contains(glm::dvec2(0.0)) || (far.side < 0.0 && contains(near_from * from) && contains(near_to * to));
	}

private:
	static constexpr int max_steps = 60;
};

} // namespace thicket::bench
