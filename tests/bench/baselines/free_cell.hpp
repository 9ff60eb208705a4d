#pragma once

#include "tests/bench/common/random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// The part of a site's Voronoi cell that is outside the site's disk of radius 1. The class
/// computes the area of this part and draws uniform points in it. All positions are relative to the
/// site.
///
/// The cell is a fan of triangles between the site and its edges. In each triangle, the free part
/// is between the edge and the disk. It is divided where the edge is nearest to the site, and where
/// the edge enters the disk. A piece is the remainder on one side, from `low` to `high` along the
/// edge. Areas and points are accurate, because they are computed from the distance to the point
/// where the edge leaves the disk. A piece a millionth wide therefore has as many correct digits as
/// a large one.
class FreeCell {
public:
	/// A corner that is at most this distance outside the disk counts as inside.
	static constexpr double tolerance = 1e-9;

	/// Replaces the cell. `neighbors` are the sites around it, in counterclockwise order. A
	/// neighbor's edge is halfway between the neighbor and the site. The corner of two adjacent
	/// edges is the center of the circle through both neighbors and the site.
	void assign(const std::vector<glm::dvec2> &neighbors) {
		pieces_.clear();
		area_ = 0.0;
		if (neighbors.empty()) {
			return;
		}
		glm::dvec2 corner = circumcenter(neighbors.back(), neighbors.front());
		for (std::size_t i = 0; i < neighbors.size(); ++i) {
			const glm::dvec2 next = circumcenter(neighbors[i], neighbors[i + 1 < neighbors.size() ? i + 1 : 0]);
			add_edge(neighbors[i], corner, next);
			corner = next;
		}
	}

	/// Returns the area of the free part. It is exactly 0 if no corner is more than `tolerance`
	/// outside the disk.
	double area() const { return area_; }

	/// Returns a uniform random point in the free part. The area must be above 0.
	glm::dvec2 draw(Xoroshiro &random) const {
		const double target = unit(random) * area_;
		const auto reached = [target](const Piece &candidate) {
			return candidate.area_up_to > target;
		};
		const auto match = std::find_if(pieces_.begin(), pieces_.end(), reached);
		return (match != pieces_.end() ? *match : pieces_.back()).draw(random);
	}

	/// Returns a uniform random number in [0, 1).
	static double unit(Xoroshiro &random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

private:
	struct Piece {
		glm::dvec2 foot;      ///< The position on the edge's line that is nearest to the site.
		glm::dvec2 direction; ///< The unit vector along the line, away from the foot.
		double height;        ///< The distance from the site to the foot.
		/// The distance from the foot to where the line leaves the disk; 0 if they do not
		/// intersect.
		double start;
		double above; ///< `height` squared minus 1 if the line misses the disk, otherwise 0.
		double low;   ///< The ends of the piece along the line, measured from `start`.
		double high;
		/// The total area of the cell's pieces up to and including this one.
		double area_up_to = 0.0;

		/// Returns a position's squared distance from the site, minus 1.
		double excess(double offset) const { return above + offset * (offset + 2.0 * start); }

		/// Returns the area between the disk and the line from `start` to `offset`, which is a
		/// triangle minus a sector.
		double area_to(double offset) const {
			// The tangent of the sector's angle.
			const double tangent = height * offset / (height * height + start * (start + offset));
			return 0.5 * ((start * offset + above) * tangent + less_its_arc(tangent));
		}

		/// First draws a position along the line by rejection sampling. The density, excess / (1 +
		/// excess), increases along the line, and at least a third of the tries are accepted. Then
		/// draws the position between the disk and the line by exact sampling.
		glm::dvec2 draw(Xoroshiro &random) const {
			const double max_weight = excess(high) / (1.0 + excess(high));
			for (;;) {
				const double offset = low + (high - low) * unit(random);
				const double excess_at_offset = excess(offset);
				if (unit(random) * max_weight * (1.0 + excess_at_offset) < excess_at_offset) {
					const double scale = std::sqrt((1.0 + unit(random) * excess_at_offset) / (1.0 + excess_at_offset));
					return scale * (foot + (start + offset) * direction);
				}
			}
		}
	};

	std::vector<Piece> pieces_;
	double area_ = 0.0;

	static double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }

	static glm::dvec2 circumcenter(glm::dvec2 a, glm::dvec2 b) {
		const double twice_area = a.x * b.y - a.y * b.x;
		return (glm::dvec2(b.y, -b.x) * dot(a, a) + glm::dvec2(-a.y, a.x) * dot(b, b)) / (2.0 * twice_area);
	}

	/// Returns x - atan(x) for x >= 0, accurate even if both are nearly equal.
	static double less_its_arc(double x) {
		if (x > 0.05) {
			return x - std::atan(x);
		}
		const double q = x * x;
		return x * q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7 - q * (1.0 / 9 - q * (1.0 / 11 - q / 13)))));
	}

	void add_edge(glm::dvec2 neighbor, glm::dvec2 from, glm::dvec2 end) {
		const double distance = std::sqrt(dot(neighbor, neighbor));
		const glm::dvec2 direction = glm::dvec2(-neighbor.y, neighbor.x) / distance;
		add_piece(0.5 * neighbor, direction, 0.5 * distance, dot(from, direction), dot(end, direction));
		add_piece(0.5 * neighbor, -direction, 0.5 * distance, -dot(end, direction), -dot(from, direction));
	}

	/// Adds the piece of an edge from `from` to `to`, measured from the foot.
	void add_piece(glm::dvec2 foot, glm::dvec2 direction, double height, double from, double end) {
		const double above = height * height - 1.0;
		const double start = std::sqrt(std::max(-above, 0.0));
		Piece candidate{.foot = foot,
				.direction = direction,
				.height = height,
				.start = start,
				.above = std::max(above, 0.0),
				.low = std::max(from - start, 0.0),
				.high = end - start};
		if (candidate.high <= candidate.low || candidate.excess(candidate.high) <= 2.0 * tolerance) {
			return;
		}
		area_ += std::max(candidate.area_to(candidate.high) - candidate.area_to(candidate.low), 0.0);
		candidate.area_up_to = area_;
		pieces_.push_back(candidate);
	}
};

} // namespace thicket::bench
