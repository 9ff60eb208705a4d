#pragma once

#include "tests/bench/common/random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket::bench {

/// What a site's own disk of radius 1 leaves free of its Voronoi cell: the free area, and uniform points in it. All
/// positions are relative to the site.
///
/// The cell is a fan of triangles between the site and its edges. In a triangle, the free part lies between the edge
/// and the disk; it is cut where the edge is nearest to the site and where it enters the disk. A piece is what is left
/// on one side, from `low` to `high` along the edge. Area and points are exact: they are computed from the distance to
/// where the edge leaves the disk, so that a piece a millionth wide has as many good digits as a large one.
class FreeCell {
public:
	/// A corner no more than this beyond the disk counts as inside.
	static constexpr double tolerance = 1e-9;

	/// Replaces the cell. `neighbors` are the sites around it, in counterclockwise order; a neighbor's edge lies
	/// halfway to it, and its corner with the next is the center of the circle through both and the site.
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

	/// 0 exactly when no corner lies more than `tolerance` beyond the disk.
	double area() const { return area_; }

	/// A point, uniform over the free part. The area must be above 0.
	glm::dvec2 draw(Xoroshiro &random) const {
		const double target = unit(random) * area_;
		const auto reached = [target](const Piece &piece) {
			return piece.area_up_to > target;
		};
		const auto found = std::find_if(pieces_.begin(), pieces_.end(), reached);
		return (found != pieces_.end() ? *found : pieces_.back()).draw(random);
	}

	/// Uniform in [0, 1).
	static double unit(Xoroshiro &random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

private:
	struct Piece {
		glm::dvec2 foot;  ///< The place of the edge's line that is nearest to the site.
		glm::dvec2 along; ///< Unit vector of the line, away from the foot.
		double height;    ///< From the site to the foot.
		double start;     ///< From the foot to where the line leaves the disk; 0 where it does not meet it.
		double above;     ///< `height` squared less 1 where the line does not meet the disk; else 0.
		double low;       ///< The piece's ends, along the line from `start` on.
		double high;
		double area_up_to = 0.0; ///< Of the cell's pieces up to this one.

		/// A place's squared distance from the site, less 1.
		double excess(double place) const { return above + place * (place + 2.0 * start); }

		/// Between the disk and the line, from `start` to `place`: a triangle less a sector.
		double area_to(double place) const {
			const double tangent = height * place / (height * height + start * (start + place)); // Of the sector.
			return 0.5 * ((start * place + above) * tangent + less_its_arc(tangent));
		}

		/// Rejection along the line, where the density is excess / (1 + excess), rising: a third of the tries or more
		/// are kept. Then outwards, between the disk and the line, exactly.
		glm::dvec2 draw(Xoroshiro &random) const {
			const double most = excess(high) / (1.0 + excess(high));
			for (;;) {
				const double place = low + (high - low) * unit(random);
				const double beyond = excess(place);
				if (unit(random) * most * (1.0 + beyond) < beyond) {
					const double scale = std::sqrt((1.0 + unit(random) * beyond) / (1.0 + beyond));
					return scale * (foot + (start + place) * along);
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

	/// x - atan(x) for x >= 0, to the last digits also where the two are nearly the same.
	static double less_its_arc(double x) {
		if (x > 0.05) {
			return x - std::atan(x);
		}
		const double q = x * x;
		return x * q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7 - q * (1.0 / 9 - q * (1.0 / 11 - q / 13)))));
	}

	void add_edge(glm::dvec2 neighbor, glm::dvec2 from, glm::dvec2 to) {
		const double distance = std::sqrt(dot(neighbor, neighbor));
		const glm::dvec2 along = glm::dvec2(-neighbor.y, neighbor.x) / distance;
		add_piece(0.5 * neighbor, along, 0.5 * distance, dot(from, along), dot(to, along));
		add_piece(0.5 * neighbor, -along, 0.5 * distance, -dot(to, along), -dot(from, along));
	}

	/// The piece of an edge from `from` to `to`, measured from the foot on.
	void add_piece(glm::dvec2 foot, glm::dvec2 along, double height, double from, double to) {
		const double above = height * height - 1.0;
		const double start = std::sqrt(std::max(-above, 0.0));
		Piece piece{.foot = foot,
				.along = along,
				.height = height,
				.start = start,
				.above = std::max(above, 0.0),
				.low = std::max(from - start, 0.0),
				.high = to - start};
		if (piece.high <= piece.low || piece.excess(piece.high) <= 2.0 * tolerance) {
			return;
		}
		area_ += std::max(piece.area_to(piece.high) - piece.area_to(piece.low), 0.0);
		piece.area_up_to = area_;
		pieces_.push_back(piece);
	}
};

} // namespace thicket::bench
