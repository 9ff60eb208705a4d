#pragma once

#include <glm/gtc/type_precision.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

namespace thicket::analysis {

/// A half-open rectangle of cells with side 2^bits.
struct CellRect {
	glm::i64vec2 min{0};
	glm::i64vec2 max{0};

	bool contains(glm::i64vec2 cell) const {
		return min.x <= cell.x && cell.x < max.x && min.y <= cell.y && cell.y < max.y;
	}
};

/// The results of `LatticeCheck`.
struct LatticeReport {
	std::uint64_t points = 0;    ///< Number of points in the region, without its border.
	std::uint64_t pairs = 0;     ///< Number of pairs whose distance was computed.
	std::uint64_t too_close = 0; ///< Number of pairs closer than the radius, including pairs in the border.
	std::uint64_t uncovered = 0; ///< Number of lattice points of the region that no point covers.
	/// The smallest squared distance of a pair.
	std::int64_t min_squared_distance = std::numeric_limits<std::int64_t>::max();
	glm::i64vec2 uncovered_at{0}; ///< One of the uncovered lattice points.

	bool perfect() const { return too_close == 0 && uncovered == 0; }
};

/// Checks a Poisson-disk set on the integer lattice without any rounding. Cells have side 2^bits,
/// and the radius is sqrt(2) * 2^bits. Two points conflict if they are closer than the radius. A
/// lattice point is covered if it is closer than the radius to a point.
///
/// Coverage is decided by subdivision. A square within the disk of one point is covered, and a
/// square that intersects no disk is not. Any other square is split, down to single lattice points,
/// so the result is exact.
class LatticeCheck {
public:
	/// Checks a region. `points` must include every point of the set within three cells of
	/// `region`, in any order, and may include farther points.
	static LatticeReport run(std::span<const glm::i64vec2> points, int bits, const CellRect &region) {
		LatticeCheck check(bits, region);
		for (const glm::i64vec2 point : points) {
			check.enter(point);
		}
		check.check_region();
		return check.report_;
	}

private:
	static constexpr std::int64_t border = 3;
	/// Points in cells farther apart than this number of cells on an axis cannot conflict.
	static constexpr std::int64_t reach = 2;
	static constexpr int max_neighbors = 25;

	struct Disks {
		std::array<glm::i64vec2, max_neighbors> centers;
		int count = 0;
	};

	int bits_;
	std::int64_t radius_squared_;
	CellRect region_;
	CellRect bordered_;
	std::int64_t columns_;
	std::vector<glm::i64vec2> point_of_cell_;
	std::vector<bool> taken_;
	LatticeReport report_;

	LatticeCheck(int bits, const CellRect &region) :
			bits_(bits), radius_squared_(std::int64_t{2} << (2 * bits)), region_(region),
			bordered_{region.min - border, region.max + border}, columns_(bordered_.max.x - bordered_.min.x) {
		const auto cells = static_cast<std::size_t>(columns_ * (bordered_.max.y - bordered_.min.y));
		point_of_cell_.resize(cells);
		taken_.resize(cells);
	}

	std::size_t index_of(glm::i64vec2 cell) const {
		return static_cast<std::size_t>((cell.y - bordered_.min.y) * columns_ + (cell.x - bordered_.min.x));
	}

	static std::int64_t squared(glm::i64vec2 v) { return v.x * v.x + v.y * v.y; }

	/// Adds a point and compares it with all earlier ones, so that every pair is compared once.
	void enter(glm::i64vec2 point) {
		const glm::i64vec2 cell(point.x >> bits_, point.y >> bits_);
		if (!bordered_.contains(cell)) {
			return;
		}
		for (std::int64_t y = cell.y - reach; y <= cell.y + reach; ++y) {
			for (std::int64_t x = cell.x - reach; x <= cell.x + reach; ++x) {
				if (bordered_.contains({x, y}) && taken_[index_of({x, y})]) {
					const std::int64_t distance = squared(point_of_cell_[index_of({x, y})] - point);
					++report_.pairs;
					report_.too_close += distance < radius_squared_ ? 1 : 0;
					report_.min_squared_distance = std::min(report_.min_squared_distance, distance);
				}
			}
		}
		taken_[index_of(cell)] = true;
		point_of_cell_[index_of(cell)] = point;
		report_.points += region_.contains(cell) ? 1 : 0;
	}

	void check_region() {
		for (std::int64_t y = region_.min.y; y < region_.max.y; ++y) {
			for (std::int64_t x = region_.min.x; x < region_.max.x; ++x) {
				const glm::i64vec2 cell(x, y);
				if (taken_[index_of(cell)]) {
					continue; // A cell's diagonal is shorter than the radius, so its own point covers it.
				}
				Disks disks;
				gather(cell, disks);
				check_square(cell * (std::int64_t{1} << bits_), std::int64_t{1} << bits_, disks);
			}
		}
	}

	void gather(glm::i64vec2 cell, Disks &r_disks) const {
		for (std::int64_t y = cell.y - reach; y <= cell.y + reach; ++y) {
			for (std::int64_t x = cell.x - reach; x <= cell.x + reach; ++x) {
				if (taken_[index_of({x, y})]) {
					r_disks.centers[static_cast<std::size_t>(r_disks.count++)] = point_of_cell_[index_of({x, y})];
				}
			}
		}
	}

	/// Adds the uncovered lattice points of [origin, origin + side) to the report.
	void check_square(glm::i64vec2 origin, std::int64_t side, const Disks &disks) {
		const glm::i64vec2 last = origin + (side - 1);
		Disks near_disks;
		for (int i = 0; i < disks.count; ++i) {
			const glm::i64vec2 center = disks.centers[static_cast<std::size_t>(i)];
			const glm::i64vec2 farthest(std::max(std::abs(origin.x - center.x), std::abs(last.x - center.x)),
					std::max(std::abs(origin.y - center.y), std::abs(last.y - center.y)));
			if (squared(farthest) < radius_squared_) {
				return;
			}
			const glm::i64vec2 nearest(std::clamp(center.x, origin.x, last.x), std::clamp(center.y, origin.y, last.y));
			if (squared(nearest - center) < radius_squared_) {
				near_disks.centers[static_cast<std::size_t>(near_disks.count++)] = center;
			}
		}
		if (near_disks.count == 0) {
			report_.uncovered += static_cast<std::uint64_t>(side * side);
			report_.uncovered_at = origin;
			return;
		}
		const std::int64_t half = side / 2;
		for (int child = 0; child < 4; ++child) {
			check_square(origin + half * glm::i64vec2(child & 1, child >> 1), half, near_disks);
		}
	}
};

} // namespace thicket::analysis
