#pragma once

#include "core/base/instance_id.hpp"
#include "core/sampling/dart.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/obstacles.hpp"
#include "core/sampling/rank.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <queue>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket::oracle {

/// A point in lattice coordinates.
struct Point {
	glm::i64vec2 lattice;
	std::uint32_t rank;
};

/// The points of a level, keyed by cell (x, y).
using Points = std::map<std::pair<std::int32_t, std::int32_t>, Point>;

/// Number of cells. Points near the edge of a finite domain depend on neighbors outside it, which
/// are missing. No observed chain of such dependencies was longer than this margin.
inline constexpr std::int32_t margin = 34;

/// Textbook dart throwing on a finite domain: a single heap holds all darts, the earliest first. It
/// shares only the definition of the darts (dart.hpp) with the sampler.
class StrictTimeHeap {
public:
	StrictTimeHeap(const PointSet &set, std::uint32_t level, const CellRect &cells, const Points &coarser,
			std::span<const Obstacle> obstacles) :
			source_(DartSource::of(set, level)), set_(set), level_(level), cells_(cells), obstacles_(obstacles) {
		for (const auto &[cell, point] : coarser) {
			const glm::i64vec2 lattice = point.lattice * std::int64_t{2};
			if (!obstructed(lattice)) {
				points_[cell_of(lattice)] = {lattice, point.rank};
			}
		}
	}

	Points run() {
		for (std::int32_t y = cells_.min.y; y < cells_.max.y; ++y) {
			for (std::int32_t x = cells_.min.x; x < cells_.max.x; ++x) {
				push({x, y}, source_.base_dart(x, y));
			}
		}
		while (!events_.empty()) {
			const auto [dart, x, y] = events_.top();
			events_.pop();
			handle({x, y}, dart);
		}
		return std::move(points_);
	}

private:
	using Event = std::tuple<DartKey, std::int32_t, std::int32_t>;

	static std::pair<std::int32_t, std::int32_t> cell_of(glm::i64vec2 lattice) {
		return {static_cast<std::int32_t>(lattice.x >> lattice_bits),
				static_cast<std::int32_t>(lattice.y >> lattice_bits)};
	}

	static glm::i64vec2 lattice_of(glm::ivec2 cell, CellPosition position) {
		return glm::i64vec2(cell) * std::int64_t{cell_size} + glm::i64vec2(position_x(position), position_y(position));
	}

	void push(glm::ivec2 cell, DartKey dart) { events_.emplace(dart, cell.x, cell.y); }

	/// Returns true if `covers` is true for any point in the 7 x 7 cells around `cell`.
	template <typename Test>
	bool any_point_near(glm::ivec2 cell, Test covers) const {
		for (std::int32_t y = cell.y - 3; y <= cell.y + 3; ++y) {
			for (std::int32_t x = cell.x - 3; x <= cell.x + 3; ++x) {
				const auto point = points_.find({x, y});
				if (point != points_.end() && covers(point->second.lattice)) {
					return true;
				}
			}
		}
		return false;
	}

	/// Returns true if the square between two lattice points lies in a single obstacle.
	bool obstructed(glm::i64vec2 low, glm::i64vec2 high) const {
		const double unit = lattice_unit(set_);
		const glm::dvec2 from = glm::dvec2(low) * unit;
		const glm::dvec2 upper = glm::dvec2(high) * unit;
		return std::ranges::any_of(obstacles_, [&](const Obstacle &each) {
			const glm::dvec2 offset = glm::max(glm::abs(from - each.center), glm::abs(upper - each.center));
			return offset.x * offset.x + offset.y * offset.y < each.radius * each.radius;
		});
	}
	bool obstructed(glm::i64vec2 lattice) const { return obstructed(lattice, lattice); }

	void handle(glm::ivec2 cell, DartKey dart) {
		if (points_.contains({cell.x, cell.y})) {
			return;
		}
		const glm::i64vec2 lattice = lattice_of(cell, dart_position(dart_level_position(dart)));
		const auto distance2 = [](glm::i64vec2 d) {
			return d.x * d.x + d.y * d.y;
		};
		if (!obstructed(lattice) && !any_point_near(cell, [&](glm::i64vec2 other) {
				return distance2(other - lattice) < radius_squared;
			})) {
			points_[{cell.x, cell.y}] = {lattice, rank_of(set_.levels, level_, dart_time(dart))};
			return;
		}
		const std::uint32_t child_level = dart_level(dart_level_position(dart)) + 1;
		if (child_level > lattice_bits) {
			return;
		}
		const std::uint32_t width = cell_size >> child_level;
		for (std::uint32_t child = 0; child < 4; ++child) {
			const CellPosition corner = square_origin(dart_level_position(dart)) + (child & 1) * width +
					(child >> 1) * (width << lattice_bits);
			const glm::i64vec2 low = lattice_of(cell, corner);
			const glm::i64vec2 high = low + std::int64_t{width} - std::int64_t{1};
			const bool is_covered = any_point_near(cell, [&](glm::i64vec2 other) {
				return distance2(glm::max(glm::abs(low - other), glm::abs(high - other))) < radius_squared;
			});
			if (!is_covered && !obstructed(low, high)) {
				push(cell, child_dart(dart, child));
			}
		}
	}

	DartSource source_;
	PointSet set_;
	std::uint32_t level_;
	CellRect cells_;
	std::span<const Obstacle> obstacles_;
	Points points_;
	std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

/// Returns the points of `level` in `cells` and in a margin around them. The points in the margin
/// may be wrong. Obstacles apply to the finest level.
inline Points points(
		const PointSet &set, const CellRect &cells, std::span<const Obstacle> obstacles = {}, std::uint32_t level = 0) {
	const CellRect domain = cells.grown(margin);
	Points coarser;
	if (level + 1 < set.levels) {
		coarser = points(set, {(domain.min >> 1) - 2, (domain.max >> 1) + 2}, {}, level + 1);
	}
	return StrictTimeHeap(set, level, domain, coarser, obstacles).run();
}

} // namespace thicket::oracle
